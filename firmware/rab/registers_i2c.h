/* The board's registers on the I2C bus, slave address 0x20. */
#ifndef RAB_REGISTERS_I2C_H
#define RAB_REGISTERS_I2C_H

#include "receiver.h"

void registers_start(void);

/* A reception whose peaks the robot wants to see itself (command SET_RAW). Main loop. */
void registers_put_raw(const struct reception* reception);

#endif
