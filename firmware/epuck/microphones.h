/* The volume at each microphone: largest minus smallest sample of a window of 100, one a scan (14.24 ms). */
#ifndef EPUCK_MICROPHONES_H
#define EPUCK_MICROPHONES_H

#include "types.h"

#define EARS 3

/* By the converter's interrupt. */
void microphones_scanned(void);
/* Of the newest whole window, counts, 0..4095; 0 right, 1 left, 2 rear. 0 until the first window is whole. */
s16 volume(u8 ear);

#endif
