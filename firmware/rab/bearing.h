/* Where a frame came from and how strong, from the peaks of the sensors that got it (fact sheet 4.3). */
#ifndef RAB_BEARING_H
#define RAB_BEARING_H

#include "board.h"
#include "types.h"

#define NO_SENSOR 12 /* no sensor had any light: bearing, range and peak are 0 */

struct place {
    s16 bearing; /* 1e-4 rad, -31415..31415, cut off towards 0 */
    u16 range;   /* strength: the more the nearer */
    u16 peak;    /* the largest, A/D counts above dark */
    u8 sensor;   /* that had it, 0..11, or NO_SENSOR */
};

void find_place(const u16* peaks, struct place* place);

#endif
