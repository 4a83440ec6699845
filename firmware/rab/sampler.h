/* Looks at the twelve demodulators every 9.8 us and keeps the changes. Sets of sensors: bit i = sensor i. */
#ifndef RAB_SAMPLER_H
#define RAB_SAMPLER_H

#include "board.h"
#include "types.h"

struct change {
    u16 tick; /* in TICK_CYCLES */
    u16 lit;  /* sensors that see the carrier from then on */
};

void sampler_start(void);
u16 sampler_tick(void);
/* Sensors that see the carrier now. */
u16 sampler_lit(void);

/* The oldest change not yet taken; 0 if there is none. Level LEVEL_RECEIVER. */
u8 sampler_take(struct change* change);
/* 1 once after changes were lost. */
u8 sampler_overrun(void);

#endif
