/* CORDIC: rotations by angles whose tangents are powers of two. */
#include "fixed.h"

#define STEPS 20
#define GAIN_INVERSE 326016437L /* of all steps, 0.607252935 * 2^COSINE_BITS */
#define GAIN_INVERSE_16 39797   /* 0.607252935 * 2^16 */
#define NORMAL 0x08000000L      /* vectors are scaled up to at least this, and below twice it */

/* atan(2^-step) */
static const s32 step_angle[STEPS] = {257359270, 151928049, 80274608, 40748645, 20453396, 10236669, 5119583,
                                      2559948,   1279993,   639999,   320000,   160000,   80000,    40000,
                                      20000,     10000,     5000,     2500,     1250,     625};

u32 divide(u32 numerator, u32 denominator, u8 bits) {
    u32 rest = 0;
    u32 quotient = 0;
    u8 left;
    for (left = 32 + bits; left != 0; --left) {
        rest <<= 1;
        if (numerator & 0x80000000UL) rest |= 1;
        numerator <<= 1;
        if (quotient & 0x80000000UL) return 0xFFFFFFFFUL;
        quotient <<= 1;
        if (rest >= denominator) {
            rest -= denominator;
            quotient |= 1;
        }
    }
    return quotient;
}

u16 square_root(u32 value) {
    u32 root = 0;
    u32 bit = 0x40000000UL;
    while (bit != 0) {
        if (value >= root + bit) {
            value -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    return root;
}

/* Turns (*x, *y), x >= 0, onto the x axis, which makes it longer by the gain; gives the angle it had. */
static s32 turn_to_axis(s32* x, s32* y) {
    s32 angle = 0;
    u8 step;
    for (step = 0; step < STEPS; ++step) {
        const s32 dx = *y >> step;
        const s32 dy = *x >> step;
        if (*y >= 0) {
            *x += dx;
            *y -= dy;
            angle += step_angle[step];
        } else {
            *x -= dx;
            *y += dy;
            angle -= step_angle[step];
        }
    }
    return angle;
}

s32 direction(s32 x, s32 y) {
    s32 half_turn = 0;
    u32 larger;
    if (x < 0) {
        half_turn = y >= 0 ? HALF_TURN : -HALF_TURN;
        x = -x;
        y = -y;
    }
    larger = y < 0 ? (u32)-y : (u32)y;
    if ((u32)x > larger) larger = x;
    if (larger == 0) return 0;
    if (x == 0) return y > 0 ? QUARTER_TURN : -QUARTER_TURN;
    while (larger >= 2 * NORMAL) {
        larger >>= 1;
        x >>= 1;
        y >>= 1;
    }
    while (larger < NORMAL) {
        larger <<= 1;
        x <<= 1;
        y <<= 1;
    }
    return half_turn + turn_to_axis(&x, &y);
}

u32 length(u32 x, u32 y) {
    u8 shift = 0;
    s32 along;
    s32 across;
    u32 scaled;
    if (x == 0) return y;
    if (y == 0) return x;
    while (x < NORMAL && y < NORMAL) {
        x <<= 1;
        y <<= 1;
        ++shift;
    }
    along = x;
    across = y;
    turn_to_axis(&along, &across);
    scaled = ((u32)along >> 16) * GAIN_INVERSE_16 + ((((u32)along & 0xFFFF) * GAIN_INVERSE_16) >> 16);
    if (shift != 0) scaled += (u32)1 << (shift - 1);
    return scaled >> shift;
}

u32 cosine(s32 angle) {
    s32 x = GAIN_INVERSE;
    s32 y = 0;
    u8 step;
    if (angle < 0) angle = -angle;
    if (angle > HALF_TURN) angle -= HALF_TURN; /* the sign does not matter */
    if (angle > QUARTER_TURN) angle = HALF_TURN - angle;
    for (step = 0; step < STEPS; ++step) {
        const s32 dx = y >> step;
        const s32 dy = x >> step;
        if (angle >= 0) {
            x -= dx;
            y += dy;
            angle -= step_angle[step];
        } else {
            x += dx;
            y -= dy;
            angle += step_angle[step];
        }
    }
    return x < 0 ? 0 : x;
}
