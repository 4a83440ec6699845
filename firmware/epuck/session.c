#include "session.h"

#include "accelerometer.h"
#include "board.h"
#include "clock.h"
#include "ircom.h"
#include "leds.h"
#include "microphones.h"
#include "motors.h"
#include "proximity.h"
#include "records.h"
#include "registers.h"
#include "uart.h"

#define SILENCE_TICKS 21                   /* 20.5 ms without a byte end a record, whole or not */
#define WATCHDOG_TICKS TICKS_PER_SECOND    /* without an actuator record for so long the wheels stop */
#define BLINK_TICKS (TICKS_PER_SECOND / 8) /* while waiting: one LED in turn for this long, each second */

enum state { WAITING, CONFIGURATION, SESSION };

static enum state state;
static union {
    u8 bytes[ACTUATOR_BYTES];
    struct actuator_record record;
} in;
static u8 in_count;
static u8 in_bad; /* a byte of the record cannot be trusted */
static union {
    u8 bytes[SENSOR_BYTES];
    struct sensor_record record;
} out;
static u16 last_record; /* tick of the newest actuator record */
static u16 waiting_since;
static u8 resting;   /* the watchdog has stopped the wheels */
static u8 announced; /* a record was sent unasked, nothing has come since */

#ifdef IRCOM
/* Directions of the sensors as the original reports them, rad; the halves of a float, since there is no library. */
static void put_bearing(u16 low, u16 high) {
    out.record.ircom_bearing[0] = low;
    out.record.ircom_bearing[1] = high;
}
static void put_bearing_of(u8 sensor) {
    switch (sensor) {
    case 0: put_bearing(0x913C, 0x40BF); break;  /* 5.986479 */
    case 1: put_bearing(0x22FD, 0x40AD); break;  /* 5.410521 */
    case 2: put_bearing(0xCBE4, 0x4096); break;  /* 4.712389 */
    case 3: put_bearing(0x927D, 0x406A); break;  /* 3.665191 */
    case 4: put_bearing(0x8D37, 0x4027); break;  /* 2.617994 */
    case 5: put_bearing(0x0FD8, 0x3FC9); break;  /* 1.570796 */
    case 6: put_bearing(0x66F2, 0x3F5F); break;  /* 0.872665 */
    default: put_bearing(0xE9D9, 0x3E97); break; /* 0.296706 */
    }
}

/* How strong a word is between two robots face to face, by the distance between their middles: fact sheet 3.10.
 * In half centimetres; the first below which the word is. */
static u8 half_centimetres(s16 strength) {
    return strength >= 3534   ? 15
           : strength >= 2104 ? 16
           : strength >= 1135 ? 17
           : strength >= 702  ? 18
           : strength >= 509  ? 19
           : strength >= 376  ? 20
           : strength >= 305  ? 21
           : strength >= 264  ? 22
           : strength >= 207  ? 23
           : strength >= 167  ? 24
           : strength >= 137  ? 25
           : strength >= 113  ? 26
           : strength >= 92   ? 27
           : strength >= 79   ? 28
           : strength >= 69   ? 29
           : strength >= 66   ? 30
           : strength >= 51   ? 31
           : strength >= 44   ? 32
           : strength >= 39   ? 33
           : strength >= 35   ? 34
           : strength >= 32   ? 35
           : strength >= 28   ? 36
           : strength >= 26   ? 37
           : strength >= 23   ? 38
           : strength >= 22   ? 39
           : strength >= 20   ? 40
           : strength >= 18   ? 41
           : strength >= 17   ? 42
           : strength >= 16   ? 43
                              : 44;
}

static void put_word(const struct ircom_word *word) {
    const u8 halves = half_centimetres(word->strength);
    out.record.ircom_data = word->data;
    out.record.ircom_sensor = word->sensor;
    put_bearing_of(word->sensor);
    out.record.ircom_range[0] = 0; /* a whole number of halves: the float's upper half has it all */
    out.record.ircom_range[1] = halves < 16   ? 0x40F0
                                : halves < 32 ? 0x4100 + (halves - 16) * 8
                                              : 0x4180 + (halves - 32) * 4;
}

static void add_word(void) {
    struct ircom_word word;
    out.record.ircom_received = ircom_receive(&word);
    if (out.record.ircom_received) put_word(&word);
}
#endif

static void answer(void) {
    u8 i;
    while (uart_sending())
        IDLE(); /* the record before is still going out */
    for (i = 0; i < SENSORS; ++i) {
        out.record.proximity[i] = proximity(i);
        out.record.light[i] = ambient(i);
    }
    for (i = 0; i < AXES; ++i)
        out.record.accelerometer[i] = acceleration(i);
    for (i = 0; i < EARS; ++i)
        out.record.microphones[i] = volume(i);
    out.record.battery_ok = PORTF & BATTERY_OK ? 1 : 0;
#ifdef IRCOM
    add_word();
#endif
    uart_send(out.bytes, SENSOR_BYTES);
}

static void rest(void) {
    motors_set(0, 0);
    resting = 1;
}

static void forget(void) {
    in_count = 0;
    in_bad = 0;
}

static void wait_for_session(void) {
    rest();
    leds_set(0, 0);
    state = WAITING;
    waiting_since = clock_ticks();
}

static void begin_session(void) {
    rest();
    leds_set(0, 0);
    state = SESSION;
    last_record = clock_ticks();
    answer();
}

static void obey(void) {
    last_record = clock_ticks();
    if (in.record.reset == END) {
        wait_for_session();
        return;
    }
    leds_set(in.record.ring_leds, in.record.other_leds);
    motors_set(in.record.left, in.record.right);
    resting = 0;
#ifdef IRCOM
    if (in.record.ircom_enabled) ircom_send(in.record.ircom_data);
#endif
    answer();
}

static void take(u16 entry) {
    if (state == WAITING) {
        forget();
        if (!announced) { /* any byte wakes, but not noise */
            if (!(entry & UART_BAD)) state = CONFIGURATION;
            return;
        }
        announced = 0; /* the forgotten session goes on, or its silence after five bytes tells a new one */
        state = SESSION;
    }
    in.bytes[in_count++] = entry;
    if (entry & UART_BAD) in_bad = 1;
    if (state == CONFIGURATION && in_count == CONFIGURATION_BYTES) {
        forget();
        begin_session();
    } else if (in_count == ACTUATOR_BYTES) {
        const u8 bad = in_bad;
        forget();
        if (bad) {
            answer();
        } else {
            obey();
        }
    }
}

/* Silence after part of a record. In a session the part is answered too, so that a Linux board that waits for
 * ever is not left waiting; five bytes with the wake-up first are a program that has been started anew. */
static void give_up_part(void) {
    const u8 started_anew = in_count == 1 + CONFIGURATION_BYTES && in.bytes[0] == WAKE_UP && !in_bad;
    if (state == CONFIGURATION) {
        wait_for_session();
    } else if (started_anew) {
        begin_session();
    } else {
        answer();
    }
    forget();
}

/* A part of a record lies there and the line has been silent too long. */
static u8 part_is_late(void) {
    const u16 last_byte =
        uart_last_byte(); /* before the clock, or a byte in between would seem in the future */
    const u16 silence = clock_ticks() - last_byte;
    return (state == CONFIGURATION || in_count != 0) && silence >= SILENCE_TICKS;
}

static void blink(void) {
    const u16 since = clock_ticks() - waiting_since;
    const u8 led = since / TICKS_PER_SECOND & 7;
    leds_set((since & (TICKS_PER_SECOND - 1)) < BLINK_TICKS ? 1 << led : 0, 0);
}

void session_start(u8 announce) {
    wait_for_session();
    if (!announce) return;
    while (uart_receive() != UART_NOTHING)
        ; /* the rest of a record to the session that is forgotten */
    answer();
    announced = 1;
}

void session_step(void) {
    u16 entry;
    while ((entry = uart_receive()) != UART_NOTHING)
        take(entry);
    if (part_is_late()) give_up_part();
    if (!resting && clock_ticks() - last_record >= WATCHDOG_TICKS) {
        rest();
        uart_listen(); /* the silence may be a receiver's that is deaf */
        resting = 0;   /* and again, as long as it lasts */
        last_record = clock_ticks();
    }
    if (state == WAITING) blink();
}
