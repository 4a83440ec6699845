/* The digital potentiometer that sets the emitters' power: 0 strongest, 255 weakest. */
#ifndef RAB_POTENTIOMETER_H
#define RAB_POTENTIOMETER_H

#include "types.h"

/* Sets the power of a new board. */
void potentiometer_start(void);
/* Sets it to this soon. Any level. */
void potentiometer_want(u8 value);
/* Main loop. */
void potentiometer_step(void);

#endif
