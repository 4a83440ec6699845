/* Ring, front and body LEDs. They are set, not toggled, so no state survives a session. */
#ifndef EPUCK_LEDS_H
#define EPUCK_LEDS_H

#include "types.h"

void leds_start(void);
/* ring: bit i = LED i; others: bit 0 front, bit 1 body. */
void leds_set(u8 ring, u8 others);

#endif
