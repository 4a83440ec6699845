/* The accelerometer's newest values, fresh each scan. */
#ifndef EPUCK_ACCELEROMETER_H
#define EPUCK_ACCELEROMETER_H

#include "types.h"

#define AXES 3

/* By the converter's interrupt. */
void accelerometer_scanned(void);
/* Raw counts, 0..4095; axis 0 to the right, 1 to the rear, 2 up; about 2048 for 0 g, 800 a g. */
s16 acceleration(u8 axis);

#endif
