/* Messages for the robot: the ten oldest wait until it takes them; newer ones are dropped. */
#ifndef RAB_MESSAGES_H
#define RAB_MESSAGES_H

#include "bearing.h"

struct message {
    u32 payload;
    struct place place;
};

/* Main loop. */
void messages_put(const struct message* message);
/* The oldest; 0 if there is none. Level LEVEL_I2C. */
u8 messages_take(struct message* message);

#endif
