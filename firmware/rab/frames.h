/* Frames on their way out: who wants to send puts a request in, the main loop turns it into chips, the
 * emitter takes it. Ten wait beside the one on the air; more are dropped, as in the original. */
#ifndef RAB_FRAMES_H
#define RAB_FRAMES_H

#include "board.h"
#include "types.h"

struct frame {
    u16 armed;                       /* emitters of port B that send at all */
    u8 bits;                         /* payload */
    u8 same;                         /* all emitters send payload[0] */
    u32 payload[SENSORS];            /* of each emitter */
    u16 ones[MAX_BITS + CHECK_BITS]; /* emitters that send a 1, bit by bit on the air */
};

/* Size of the payload from now on, 8, 16, 24 or 32 bits (anything else is ignored); what waits is forgotten,
 * what is on the air goes on as it began. Any level. */
void frames_set_bits(u8 bits);
u8 frames_bits(void);

/* Asks for a frame with one payload on all emitters, or with payload[i] on each emitter whose bit is set in
 * `emitters`. Level LEVEL_I2C. */
void frames_send_all(u32 payload);
void frames_send_each(u16 emitters, const u32* payload);

/* Main loop: turns the oldest request without chips into chips. */
void frames_build(void);

/* Emitter: the oldest frame with chips, null if there is none; begun, it stays until it is done with. */
const struct frame* frames_next(void);
void frames_begin(void);
void frames_done(void);

#endif
