/* What the booth senses: who stands in it, and its battery. */
#ifndef BOOTH_H
#define BOOTH_H

#include "types.h"

void booth_start(void);
/* To be called often. */
void booth_step(void);
/* A robot stands in it: the back barrier interrupted, the front one free, for 400 ms. */
u8 booth_present(void);
u16 booth_battery_mv(void);
/* The battery has been empty for so long that the booth must be switched off. */
u8 booth_exhausted(void);

#endif
