#include "walk.h"

#include "../epuck/clock.h"
#include "../epuck/motors.h"
#include "../epuck/proximity.h"
#include "../epuck/types.h"

#define CRUISE 300  /* steps/s: 39 mm/s */
#define STEP 51     /* ticks between decisions: 50 ms */
#define NEAR 250    /* counts of proximity that turn the robot */
#define LEG 20      /* decisions of a leg at least */

static u16 next;
static u16 noise;
static s16 turn;
static u8 leg;
static u8 avoiding;

/* A shift register of 16 bits (taps 16, 14, 13, 11), stirred by the noise of the converter. */
static u16 drawn(void) {
    noise ^= (u16)ambient(2) & 3;
    if (noise == 0) noise = 1;
    noise = (noise >> 1) ^ (noise & 1 ? 0xB400 : 0);
    return noise;
}

/* Braitenberg: what is seen on one side slows the wheel of the other. Sensors 0..2 look right, 7..5 left. */
void walk_step(void) {
    s16 right;
    s16 left;
    if ((s16)(clock_ticks() - next) < 0) return;
    next = clock_ticks() + STEP;
    right = proximity(0) + proximity(1) + (proximity(2) >> 1);
    left = proximity(7) + proximity(6) + (proximity(5) >> 1);
    if (right > NEAR || left > NEAR) {
        if (!avoiding) turn = right >= left ? -CRUISE : CRUISE; /* away from the nearer side */
        avoiding = 1; /* and on that way round, or a corner would hold it */
        motors_set(turn, -turn);
        leg = 0;
        return;
    }
    avoiding = 0;
    if (leg == 0) {
        leg = LEG + (drawn() & 31);
        turn = (s16)(drawn() & 255) - 128;
    }
    --leg;
    motors_set(CRUISE + turn, CRUISE - turn);
}

void walk_stop(void) {
    motors_set(0, 0);
}
