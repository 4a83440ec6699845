#include "leds.h"

#include "board.h"
#include "registers.h"

void leds_start(void) {
    leds_set(0, 0);
    TRISA &= ~RING_LEDS;
    TRISC &= ~(FRONT_LED | BODY_LED);
}

void leds_set(u8 ring, u8 others) {
    u16 a = 0;
    u16 c = LATC & ~(FRONT_LED | BODY_LED);
    if (ring & 0x01) a |= LED0;
    if (ring & 0x02) a |= LED1;
    if (ring & 0x04) a |= LED2;
    if (ring & 0x08) a |= LED3;
    if (ring & 0x10) a |= LED4;
    if (ring & 0x20) a |= LED5;
    if (ring & 0x40) a |= LED6;
    if (ring & 0x80) a |= LED7;
    if (others & 0x01) c |= FRONT_LED;
    if (others & 0x02) c |= BODY_LED;
    LATA = a; /* the ring LEDs are port A's only outputs */
    LATC = c;
}
