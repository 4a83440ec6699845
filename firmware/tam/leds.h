/* The LED driver TLC59116: three colour LEDs and the light barriers' infra-red LEDs. */
#ifndef LEDS_H
#define LEDS_H

#include "types.h"

/* 0: the driver does not answer. */
u8 leds_start(void);
void leds_colour(u8 red, u8 green, u8 blue);
/* The light barriers' infra-red LEDs, at the duty of the original firmware. */
void leds_infrared(u8 on);
/* Transfers that failed. */
u16 leds_failures(void);

#endif
