#include "proximity.h"

#include "board.h"
#include "registers.h"

/* A scan is 8 channels of (1 TAD sampling + 14 TAD conversion) of 10 cycles each: 1200 cycles. */
#define SCANS_LIT 4   /* 325.5 us: the phototransistor has settled */
#define SCANS_PAIR 40 /* 3.26 ms: each emitter is on 2.5 % of the time */
#define PAIRS 4

static volatile s16 ambient_value[SENSORS];
static volatile s16 proximity_value[SENSORS];
static volatile u8 rounds;
static u8 scan;
static u8 pair;
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
    return (&ADCBUF0)[pair];
}
static s16 rear_result(void) {
    return (&ADCBUF4)[pair];
}

void INTERRUPT _ADCInterrupt(void) {
    IFS0 &= ~ADIF;
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
    ADPCFG = ~PHOTOTRANSISTORS; /* 0 = analogue */
    ADCSSL = PHOTOTRANSISTORS;
    ADCHS = 0;
    ADCON2 = CSCNA | SMPI(SENSORS);
    ADCON3 = SAMC(1) | ADCS(20); /* TAD = 10 cycles = 678 ns */
    IFS0 &= ~ADIF;
    IPC2 = (IPC2 & ~IP_MASK(ADIP)) | ADIP(LEVEL_ADC);
    IEC0 |= ADIF;
    ADCON1 = ADON | SSRC_AUTO | ASAM;
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
