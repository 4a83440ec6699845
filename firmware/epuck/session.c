#include "session.h"

#include "accelerometer.h"
#include "board.h"
#include "clock.h"
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
    if (!resting && clock_ticks() - last_record >= WATCHDOG_TICKS) rest();
    if (state == WAITING) blink();
}
