/* What goes over the UARTs: messages to and commands from the robot, four hexadecimal digits from a PC. */
#ifndef RAB_SERIAL_H
#define RAB_SERIAL_H

#include "messages.h"

/* The boot line and what the sensors read in the dark. */
void serial_announce(void);
/* Twelve bytes: payload, bearing in rad as IEEE number, range, peak; least significant byte first. */
void serial_send_message(const struct message* message);
/* Main loop. */
void serial_step(void);

#endif
