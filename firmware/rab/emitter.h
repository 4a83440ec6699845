/* The carrier and the chips: timer 1 puts one chip after the other on the emitters' gates. */
#ifndef RAB_EMITTER_H
#define RAB_EMITTER_H

#include "types.h"

/* The seed sets this board's random waits apart from others'. */
void emitter_start(u16 seed);

#endif
