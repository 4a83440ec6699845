/* A whole exchange with another e-puck over the air, and the other e-puck's side of it. Both report to UART2. */
#ifndef BLUETOOTH_EXCHANGE_H
#define BLUETOOTH_EXCHANGE_H

#include "../epuck/types.h"

/* Looks for e-pucks (5 x 1.28 s), asks the first one's name, links with it by the PIN in that name, sends
 * `line` and an end of line, waits 2 s for "yes", releases. Reports how long each took, or what failed:
 * "nobody found", "no name", "not linked". 0: it did not come to a link. */
u8 exchange(const char* line);

#define LISTEN_NOTHING 0
#define LISTEN_LINKED 1
#define LISTEN_RELEASED 2
#define LISTEN_BYTE 3

/* Takes the next thing that has come: a link, its release, a byte of a line. Lines are reported ("heard ...")
 * and answered with "yes". */
u8 listen(void);

/* Waits for so many ticks of 1/1024 s. */
void pause(u16 ticks);

#define SECONDS(n) ((u16)((n) * (u32)TICKS_PER_SECOND))

#endif
