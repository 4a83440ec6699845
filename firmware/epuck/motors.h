/* The two stepper motors: timer 5 steps the left one, timer 4 the right one. */
#ifndef EPUCK_MOTORS_H
#define EPUCK_MOTORS_H

#include "types.h"

#define MAXIMUM_SPEED 1000 /* steps/s: above that the motors lose steps */

void motors_start(void);
/* Steps/s, forward positive, clamped; 0 switches the coils off. Repeating a value changes nothing. */
void motors_set(s16 left, s16 right);

#endif
