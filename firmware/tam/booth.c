#include "booth.h"

#include "board.h"
#include "clock.h"
#include "leds.h"
#include "registers.h"

#define CYCLE_MS 50
#define LIT_MS 10            /* the LEDs shine for so long before the sensors are read */
#define LEAST_BEAM 120       /* counts between lit and dark: less is an interrupted beam */
#define MICROVOLTS_PER_COUNT 32158ul /* 3.3 V / 1024 * (42.2 + 4.7) / 4.7 */
#define EMPTY_MV 2700
#define RECOVERED_MV 3000
#define EMPTY_READINGS 10

enum { FRONT, BACK, BARRIERS };
static const u8 kChannel[BARRIERS] = {FRONT_SENSE, BACK_SENSE};

static u32 cycle_start;
static u8 lit;
static u16 dark[BARRIERS];
static u8 history[BARRIERS]; /* newest in bit 0, 1 = interrupted */
static u8 present;
static u16 battery;
static u8 empty;

static u16 convert(u8 channel) {
    ADMUX = REFS_AVCC | channel;
    ADCSRA |= ADSC;
    while (ADCSRA & ADSC)
        ; /* 104 us */
    return ADC;
}

/* On only while something is measured: each SLEEP would begin a conversion of whatever channel was last. */
static void converter(u8 on) {
    ADCSRA = on ? ADEN | ADPS_128 : 0; /* 125 kHz; the first conversion takes 200 us */
}

void booth_start(void) {
    DIDR0 = 1 << FRONT_SENSE | 1 << BATTERY_SENSE | 1 << BACK_SENSE;
    cycle_start = clock_ms();
}

static void judge(void) {
    if (history[FRONT] == 0x00 && history[BACK] == 0xFF) present = 1;
    if (history[FRONT] == 0x00 && history[BACK] == 0x00) present = 0;
}

static void read_battery(void) {
    battery = (u16)(convert(BATTERY_SENSE) * MICROVOLTS_PER_COUNT / 1000);
    if (battery > RECOVERED_MV) empty = 0;
    if (battery <= EMPTY_MV && empty < EMPTY_READINGS) ++empty;
}

void booth_step(void) {
    u8 i;
    if (lit && clock_passed(cycle_start, LIT_MS)) {
        converter(1);
        for (i = 0; i < BARRIERS; ++i) {
            const u16 level = convert(kChannel[i]);
            const u16 beam = level > dark[i] ? level - dark[i] : dark[i] - level;
            history[i] = (u8)(history[i] << 1 | (beam < LEAST_BEAM));
        }
        converter(0);
        leds_infrared(0);
        lit = 0;
        judge();
    } else if (!lit && clock_passed(cycle_start, CYCLE_MS)) {
        cycle_start += CYCLE_MS;
        converter(1);
        read_battery();
        for (i = 0; i < BARRIERS; ++i)
            dark[i] = convert(kChannel[i]);
        converter(0);
        leds_infrared(1);
        lit = 1;
    }
}

u8 booth_present(void) {
    return present;
}

u16 booth_battery_mv(void) {
    return battery;
}

u8 booth_exhausted(void) {
    return empty >= EMPTY_READINGS;
}
