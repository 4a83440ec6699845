/* Time since reset in ticks of 1/1024 s, from timer 1. */
#ifndef EPUCK_CLOCK_H
#define EPUCK_CLOCK_H

#include "types.h"

#define TICKS_PER_SECOND 1024

void clock_start(void);
/* Wraps after 64 s: only differences below that mean anything. */
u16 clock_ticks(void);

#endif
