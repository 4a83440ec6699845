/* Twelve receivers, one a sensor, each with its own frame, clock and errors; sensors that got the same frame
 * together make one reception. Runs every 39 us at LEVEL_RECEIVER. */
#ifndef RAB_RECEIVER_H
#define RAB_RECEIVER_H

#include "board.h"
#include "types.h"

struct reception {
    u32 payload;
    u16 peak[SENSORS]; /* above dark; 0 where the frame was not received */
};

void receiver_start(void);

/* Payload size from now on; frames on their way in are forgotten. */
void receiver_set_bits(u8 bits);

/* The oldest reception not yet taken; 0 if there is none. Main loop. */
u8 receiver_take(struct reception* reception);

/* Sensors lit for 2 ms and more: that is no frame but the sun or a lamp. */
u16 receiver_dazzled(void);

/* Measures darkness again: when the air has been free of light for 2 ms after the detectors were discharged.
 */
void receiver_measure_dark(void);
u8 receiver_measuring_dark(void);

#endif
