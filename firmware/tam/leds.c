#include "leds.h"

#include "clock.h"
#include "registers.h"

#define ADDRESS 0xC0
#define MODE1 0x00
#define PWM0 0x02
#define LEDOUT0 0x14
#define ALL_REGISTERS 0x80 /* the register number counts up */
#define DIMMED 0xAA        /* four LEDs by their PWM registers */

#define LEDS 16
#define INFRARED_DUTY 55
#define TWBR_100KHZ 72
#define LONGEST_MS 2 /* of one step on the bus */

/* Outputs in the driver's order: infra-red, red, blue, green of the right board; red, blue, green in the middle; red, blue,
   green, infra-red of the left board; two spare; blue, green, red on top. */
static const u8 kRed[] = {1, 4, 7, 15}, kGreen[] = {3, 6, 9, 14}, kBlue[] = {2, 5, 8, 13};
static const u8 kInfrared[] = {0, 10};
#define COLOUR_LEDS 4
#define TOP 3 /* of the arrays above */

static u8 duty[LEDS];
static u16 failures;

/* Waits for the end of a step. A bus that hangs is let go. */
static u8 step(u8 control) {
    const u32 start = clock_ms();
    TWCR = control | TWINT | TWEN;
    while (!(TWCR & TWINT))
        if (clock_passed(start, LONGEST_MS + 1)) {
            TWCR = 0;
            return 0;
        }
    return TWSR & 0xF8;
}

static u8 byte(u8 value, u8 expected) {
    TWDR = value;
    return step(0) == expected;
}

/* Writes `count` registers from `first` on. */
static u8 write(u8 first, const u8 *values, u8 count) {
    u8 ok = step(TWSTA) == 0x08 && byte(ADDRESS, 0x18) && byte(first | ALL_REGISTERS, 0x28);
    while (ok && count--)
        ok = byte(*values++, 0x28);
    TWCR = TWINT | TWEN | TWSTO;
    if (!ok) ++failures;
    return ok;
}

u8 leds_start(void) {
    static const u8 mode[] = {0x01, 0x00}; /* oscillator on, answers the call to all */
    static const u8 drive[] = {DIMMED, DIMMED, DIMMED, DIMMED};
    TWSR = 0;
    TWBR = TWBR_100KHZ;
    return write(PWM0, duty, LEDS) && write(LEDOUT0, drive, sizeof drive) && write(MODE1, mode, sizeof mode);
}

void leds_colour(u8 red, u8 green, u8 blue) {
    u8 i;
    for (i = 0; i < COLOUR_LEDS; ++i) {
        /* As the original firmware has it: the boards' red at two thirds, the top's in full. */
        duty[kRed[i]] = i == TOP ? red : (u8)(red * 2u / 3u);
        duty[kGreen[i]] = green;
        duty[kBlue[i]] = blue;
    }
    write(PWM0, duty, LEDS);
}

void leds_infrared(u8 on) {
    u8 i;
    for (i = 0; i < sizeof kInfrared; ++i)
        duty[kInfrared[i]] = on ? INFRARED_DUTY : 0;
    write(PWM0, duty, kInfrared[1] + 1);
}

u16 leds_failures(void) {
    return failures;
}
