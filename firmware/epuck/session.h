/* The conversation with the Linux board: waiting, configuration, then a sensor record for each actuator
 * record until the end record. README.md says where it does better than the original. */
#ifndef EPUCK_SESSION_H
#define EPUCK_SESSION_H

#include "types.h"

/* announce: send one sensor record at once, for a Linux board that waits for an answer this chip forgot. */
void session_start(u8 announce);
/* Handles what has come and what has become due; call it after every interrupt. */
void session_step(void);

#endif
