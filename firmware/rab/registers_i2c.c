#include "registers_i2c.h"

#include "commands.h"
#include "messages.h"
#include "registers.h"

#define SLAVE_ADDRESS 0x20

/* Readable registers beside the writable ones of commands.h */
enum reading {
    POP = 0,
    DATA_1 = 1,
    DATA_0 = 2,
    BEARING_HIGH = 3,
    BEARING_LOW = 4,
    RANGE_HIGH = 5,
    RANGE_LOW = 6,
    PEAK_HIGH = 7,
    PEAK_LOW = 8,
    SENSOR = 9,
    DATA_3 = 10,
    DATA_2 = 11,
    RAW_PENDING = 20,
    RAW_PEAKS = 21,
    RAW_DATA_1 = 45,
    RAW_DATA_0 = 46
};

static struct message message;  /* what registers 1..11 show */
static struct reception shown;  /* what registers 21..46 show */
static struct reception newest; /* what the next reading of RAW_PENDING will show */
static volatile u8 raw_pending;
static u8 pointer;
static u8 run;         /* registers read on without a new pointer */
static u8 has_pointer; /* the write transaction's next byte is a value */
static u32 high;       /* part of the payload above the byte to come */

static u8 read_raw(u8 number) {
    u16 peak;
    if (number == RAW_PENDING) {
        if (raw_pending) shown = newest;
        return raw_pending;
    }
    if (number == RAW_DATA_1) return shown.payload >> 8;
    if (number == RAW_DATA_0) {
        raw_pending = 0;
        return shown.payload;
    }
    if (number > RAW_DATA_0) return 0;
    number -= RAW_PEAKS;
    peak = shown.peak[number >> 1];
    return number & 1 ? peak : peak >> 8;
}

static u8 read(u8 number) {
    switch (number) {
    case POP:
        return messages_take(&message);
    case DATA_1:
        return message.payload >> 8;
    case DATA_0:
        return message.payload;
    case BEARING_HIGH:
        return (u16)message.place.bearing >> 8;
    case BEARING_LOW:
        return message.place.bearing;
    case RANGE_HIGH:
        return message.place.range >> 8;
    case RANGE_LOW:
        return message.place.range;
    case PEAK_HIGH:
        return message.place.peak >> 8;
    case PEAK_LOW:
        return message.place.peak;
    case SENSOR:
        return message.place.sensor;
    case DATA_3:
        return (u16)(message.payload >> 16) >> 8;
    case DATA_2:
        return message.payload >> 16;
    default:
        return number >= RAW_PENDING ? read_raw(number) : 0;
    }
}

static void write(u8 number, u8 value) {
    switch (number) {
    case SET_HIGH:
        high = value;
        break;
    case SHIFT_HIGH:
    case SHIFT_HIGH_TOO:
        high = high << 8 | value;
        break;
    case SEND_ALL:
        command_obey(SEND_ALL, high << 8 | value);
        break;
    default:
        command_obey(number, number < SENSORS ? high << 8 | value : (u32)value);
    }
}

/* The master waits with SCL held low until this has answered: a few microseconds, whatever it asked for. A
 * run of registers gives the first one twice, as the original does. */
void INTERRUPT _SI2C1Interrupt(void) {
    const u16 status = I2C1STAT;
    IFS1 &= ~SI2C1IF;
    if (status & I2COV) I2C1STAT &= ~I2COV;
    if (status & R_W) {
        if (!(status & D_A)) {
            (void)I2C1RCV;
            I2C1TRN = read(pointer);
        } else {
            I2C1TRN = read(pointer + run++);
        }
    } else {
        const u8 byte = I2C1RCV;
        if (!(status & D_A)) {
            has_pointer = 0;
        } else if (!has_pointer) {
            pointer = byte;
            run = 0;
            has_pointer = 1;
        } else {
            write(pointer, byte);
        }
    }
    I2C1CON |= SCLREL;
}

void registers_start(void) {
    I2C1ADD = SLAVE_ADDRESS;
    IFS1 &= ~SI2C1IF;
    IPC4 = (IPC4 & ~IP_MASK(SI2C1IP)) | SI2C1IP(LEVEL_I2C);
    IEC1 |= SI2C1IF;
    I2C1CON = I2CEN | SCLREL | STREN;
}

void registers_put_raw(const struct reception* reception) {
    IEC1 &= ~SI2C1IF; /* a master that reads now waits a moment */
    newest = *reception;
    raw_pending = 1;
    IEC1 |= SI2C1IF;
}
