/* Integer arithmetic for angles and roots. An angle is a s32 in 1e-4 rad / 32768. */
#ifndef RAB_FIXED_H
#define RAB_FIXED_H

#include "types.h"

#define ANGLE_BITS 15
#define HALF_TURN 1029437081L   /* pi */
#define QUARTER_TURN 514718540L /* pi / 2 */
#define COSINE_BITS 29

/* Floor of numerator * 2^bits / denominator; 0xFFFFFFFF when that does not fit. Denominator 1..2^31. */
u32 divide(u32 numerator, u32 denominator, u8 bits);

/* Floor of the square root. */
u16 square_root(u32 value);

/* atan2(y, x), -HALF_TURN..HALF_TURN; 0 when both are 0. |x|, |y| up to 2^31 - 1. Good to 2e-6 rad. */
s32 direction(s32 x, s32 y);

/* sqrt(x * x + y * y), rounded; x, y up to 2^29. Good to 3e-6 of the value. */
u32 length(u32 x, u32 y);

/* |cos(angle)| * 2^COSINE_BITS; angle -2 * HALF_TURN..2 * HALF_TURN. */
u32 cosine(s32 angle);

#endif
