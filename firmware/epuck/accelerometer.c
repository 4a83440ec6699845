#include "accelerometer.h"

#include "analog.h"

#define X_CHANNEL 5 /* y and z follow */

static volatile s16 value[AXES];

void accelerometer_scanned(void) {
    u8 axis;
    for (axis = 0; axis < AXES; ++axis)
        value[axis] = ANALOG(X_CHANNEL + axis);
}

s16 acceleration(u8 axis) {
    return value[axis];
}
