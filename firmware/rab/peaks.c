#include "peaks.h"

#include "registers.h"

static volatile u16 awaited;
static volatile u8 converting; /* 1 + sensor, 0: none */
static volatile u16 raw[SENSORS];
static u16 dark[SENSORS];
static u16 discharged; /* reset lines as they stand */

/* Starts the next conversion that somebody waits for. */
static void convert(void) {
    u16 bit = 1;
    u8 sensor = 0;
    if (awaited == 0) {
        converting = 0;
        return;
    }
    while (!(awaited & bit)) {
        bit <<= 1;
        ++sensor;
    }
    converting = 1 + sensor;
    AD1CHS0 = FIRST_PEAK_INPUT + sensor;
    AD1CON1 |= SAMP;
}

void INTERRUPT _ADC1Interrupt(void) {
    const u8 sensor = converting - 1;
    IFS0 &= ~AD1IF;
    raw[sensor] = ADC1BUF0;
    awaited &= ~(1 << sensor);
    convert();
}

void peaks_start(void) {
    LATA &= ~RESETS_A;
    LATF &= ~RESETS_F;
    LATG &= ~RESETS_G;
    TRISA &= ~RESETS_A;
    TRISF &= ~RESETS_F;
    TRISG &= ~RESETS_G;
    AD1PCFGL = 0xFFFF;
    AD1PCFGH = ~PEAK_INPUTS_H;
    AD1CON2 = 0;
    AD1CON3 = SAMC(10) | ADCS(11); /* TAD = 275 ns; 10 sampling + 14 converting: 6.6 us */
    AD1CON1 = ADON | AD12B | SSRC_AUTO;
    IFS0 &= ~AD1IF;
    IPC3 = (IPC3 & ~IP_MASK(AD1IP)) | AD1IP(LEVEL_RECEIVER);
    IEC0 |= AD1IF;
}

void peaks_reset(u16 sensors) {
    u16 f;
    u16 g;
    u16 a;
    if (sensors == discharged) return;
    discharged = sensors;
    f = sensors & 0x0003;
    g = (sensors >> 2 & 0x0003) | (sensors << 8 & 0xF000);
    a = (sensors >> 11 & 0x0001) | (sensors >> 9 & 0x0002) | (sensors >> 5 & 0x0010) |
        (sensors >> 3 & 0x0020);
    LATF = (LATF & ~RESETS_F) | f;
    LATG = (LATG & ~RESETS_G) | g;
    LATA = (LATA & ~RESETS_A) | a;
}

void peaks_read(u16 sensors) {
    awaited |= sensors;
    if (converting == 0) convert();
}

u16 peaks_awaited(void) {
    return awaited;
}

u16 peak_raw(u8 sensor) {
    return raw[sensor];
}

u16 peak_above_dark(u8 sensor) {
    const u16 value = raw[sensor];
    return value > dark[sensor] ? value - dark[sensor] : 0;
}

void peaks_set_dark(void) {
    u8 i;
    for (i = 0; i < SENSORS; ++i)
        dark[i] = raw[i];
}

u16 peak_dark(u8 sensor) {
    return dark[sensor];
}
