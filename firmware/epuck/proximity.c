#include "proximity.h"

#include "analog.h"
#include "board.h"

#define FIRST_PHOTOTRANSISTOR 8 /* AN8, the others follow */
#define SCANS_LIT 2             /* 284.8 us: the phototransistor has settled */
#define SCANS_PAIR 23           /* 3.28 ms: each emitter is on 2.2 % of the time */
#define PAIRS 4
#ifdef IRCOM
#define VOLATILE_SCAN volatile /* the main loop looks at them */
#else
#define VOLATILE_SCAN
#endif

static volatile s16 ambient_value[SENSORS];
static volatile s16 proximity_value[SENSORS];
static volatile u8 rounds;
static VOLATILE_SCAN u8 scan;
static VOLATILE_SCAN u8 pair;
static s16 before_front;
static s16 before_rear;

static void pulse(u8 on) {
    switch (pair) {
    case 0: LATF = on ? LATF | PULSE0 : LATF & ~PULSE0; break;
    case 1: LATF = on ? LATF | PULSE1 : LATF & ~PULSE1; break;
    case 2: LATG = on ? LATG | PULSE2 : LATG & ~PULSE2; break;
    default: LATG = on ? LATG | PULSE3 : LATG & ~PULSE3; break;
    }
}

/* Results of sensors pair and pair + 4. */
static s16 front_result(void) {
    return ANALOG(FIRST_PHOTOTRANSISTOR + pair);
}
static s16 rear_result(void) {
    return ANALOG(FIRST_PHOTOTRANSISTOR + PAIRS + pair);
}

#ifdef IRCOM
static volatile u8 held;

void proximity_hold(u8 hold) {
    held = hold;
}
u8 proximity_lit(void) {
    return scan != 0 && scan <= SCANS_LIT ? pair : PROXIMITY_DARK;
}
#endif

void proximity_scanned(void) {
#ifdef IRCOM
    if (held && scan == 0) return;
#endif
    if (scan == 0) {
        before_front = front_result();
        before_rear = rear_result();
        pulse(1);
    } else if (scan == SCANS_LIT) {
        const s16 front = front_result();
        const s16 rear = rear_result();
        pulse(0);
        ambient_value[pair] = before_front;
        ambient_value[pair + PAIRS] = before_rear;
        proximity_value[pair] = before_front - front;
        proximity_value[pair + PAIRS] = before_rear - rear;
        if (pair == PAIRS - 1) rounds |= 1;
    }
    if (++scan == SCANS_PAIR) {
        scan = 0;
        pair = (pair + 1) & (PAIRS - 1);
    }
}

void proximity_start(void) {
    LATF &= ~(PULSE0 | PULSE1);
    LATG &= ~(PULSE2 | PULSE3);
    TRISF &= ~(PULSE0 | PULSE1);
    TRISG &= ~(PULSE2 | PULSE3);
}

u8 proximity_ready(void) {
    return rounds;
}
s16 proximity(u8 sensor) {
    return proximity_value[sensor];
}
s16 ambient(u8 sensor) {
    return ambient_value[sensor];
}
