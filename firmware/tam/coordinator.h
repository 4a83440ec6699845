/* The coordinator's protocol: reports to it, commands from it. TAM fact sheet, section 7. */
#ifndef COORDINATOR_H
#define COORDINATOR_H

#include "types.h"

/* Resets the radio module, joins the network that the switches say, and begins to look for the coordinator. */
void coordinator_start(void);
/* To be called often. */
void coordinator_step(void);
/* The coordinator has asked the booth to switch itself off. */
u8 coordinator_says_off(void);
/* The byte for the robot; 0 until the coordinator sets one. */
u8 coordinator_word(void);
/* The robot has sent a byte. */
void coordinator_robot_says(u8 word);

#endif
