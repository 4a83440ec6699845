/* Milliseconds since the start, from timer 0; and the watchdog, for all that waits. */
#ifndef CLOCK_H
#define CLOCK_H

#include "types.h"

void clock_start(void);
/* Wraps after 49 days. */
u32 clock_ms(void);
/* `ms` milliseconds or more have passed since `start`. */
u8 clock_passed(u32 start, u32 ms);
/* Busy for at least `ms`; the watchdog is served. */
void clock_wait(u16 ms);

#endif
