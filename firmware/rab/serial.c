#include "serial.h"

#include "commands.h"
#include "fixed.h"
#include "frames.h"
#include "peaks.h"
#include "registers.h"
#include "sampler.h"
#include "uart.h"

#define COMMAND_PAUSE 2048  /* ticks, 20 ms: a command that stays incomplete so long is forgotten */
#define BEARING_UNITS 10000 /* a rad */
#define MANTISSA_BITS 23
#define EXPONENT_BIAS 127

static u8 in_command; /* 1: `command` is known, its bytes are coming */
static u8 command;
static u8 bytes_left;
static u32 value;
static u16 last_byte; /* tick */
static u16 digits;    /* of the PC's number */
static u8 digit_count;

static void put_number(u16 number) {
    char text[6];
    u8 at = sizeof text - 1;
    text[at] = 0;
    do {
        text[--at] = '0' + number % 10;
        number /= 10;
    } while (number != 0);
    uart_text(PC, &text[at]);
}

void serial_announce(void) {
    u8 i;
    uart_text(PC, "E-PUCK RANGE AND BEARING STARTED\n\r");
    for (i = 0; i < SENSORS; ++i) {
        put_number(peak_dark(i));
        uart_put(PC, ' ');
    }
    uart_text(PC, "\n\r");
}

/* The bearing in rad as IEEE single. */
static u32 ieee(s16 bearing) {
    const u32 sign = bearing < 0 ? 0x80000000UL : 0;
    u32 numerator = bearing < 0 ? -(s32)bearing : (s32)bearing;
    u32 denominator = BEARING_UNITS;
    u16 exponent = EXPONENT_BIAS;
    if (numerator == 0) return 0;
    while (numerator < denominator) {
        numerator <<= 1;
        --exponent;
    }
    while (numerator >= 2 * denominator) {
        denominator <<= 1;
        ++exponent;
    }
    return sign | (u32)exponent << MANTISSA_BITS |
           (divide(numerator, denominator, MANTISSA_BITS) & 0x7FFFFFUL);
}

static void put_bytes(u32 number, u8 count) {
    for (; count != 0; --count) {
        uart_put(ROBOT, number);
        number >>= 8;
    }
}

void serial_send_message(const struct message* message) {
    put_bytes(message->payload, 4);
    put_bytes(ieee(message->place.bearing), 4);
    put_bytes(message->place.range, 2);
    put_bytes(message->place.peak, 2);
}

/* Commands share their state with the I2C registers; a master that asks now waits a moment. */
static void obey(u8 number, u32 argument) {
    IEC1 &= ~SI2C1IF;
    command_obey(number, argument);
    IEC1 |= SI2C1IF;
}

/* A register number, then as many bytes as the payload has, most significant first. */
static void take_robot_byte(u8 byte) {
    const u16 now = sampler_tick();
    if (in_command && (u16)(now - last_byte) > COMMAND_PAUSE) in_command = 0;
    last_byte = now;
    if (!in_command) {
        if (byte > SET_BITS) return;
        in_command = 1;
        command = byte;
        value = 0;
        bytes_left = frames_bits() >> 3;
        return;
    }
    value = value << 8 | byte;
    if (--bytes_left != 0) return;
    in_command = 0;
    obey(command, command < SENSORS || command == SEND_ALL ? value : value & 0xFF);
}

static void put_digit(u8 digit) {
    uart_put(PC, digit < 10 ? '0' + digit : 'a' - 10 + digit);
}

/* Four hexadecimal digits are sent on all emitters; anything else begins anew. */
static void take_pc_byte(u8 byte) {
    u8 digit;
    u8 shift;
    if (byte >= '0' && byte <= '9') {
        digit = byte - '0';
    } else if ((byte | 0x20) >= 'a' && (byte | 0x20) <= 'f') {
        digit = (byte | 0x20) - 'a' + 10;
    } else {
        digit_count = 0;
        return;
    }
    digits = digits << 4 | digit;
    if (++digit_count < 4) return;
    digit_count = 0;
    obey(SEND_ALL, digits);
    uart_text(PC, "Received: ");
    for (shift = 12; shift != 0 && digits >> shift == 0; shift -= 4)
        ;
    for (;; shift -= 4) {
        put_digit(digits >> shift & 0xF);
        if (shift == 0) break;
    }
    uart_text(PC, "\n\r");
}

void serial_step(void) {
    u16 byte;
    while ((byte = uart_get(ROBOT)) != UART_NOTHING)
        take_robot_byte(byte);
    while ((byte = uart_get(PC)) != UART_NOTHING)
        take_pc_byte(byte);
}
