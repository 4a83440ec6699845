/* What the robot wants, over I2C or UART1, in the board's register numbers (fact sheet 2.1). */
#ifndef RAB_COMMANDS_H
#define RAB_COMMANDS_H

#include "receiver.h"
#include "types.h"

enum command {
    SET_RANGE = 12,
    SET_HIGH = 13,
    SEND_ALL = 14,
    SEND_EACH = 15,
    MEASURE_DARK = 16,
    SET_RAW = 17,
    SET_UART = 18,
    SHIFT_HIGH = 19,
    SHIFT_HIGH_TOO = 20,
    SET_BITS = 21
};

/* Obeys a command with its whole payload (0..11, SEND_ALL), with its value otherwise. Level LEVEL_I2C. */
void command_obey(u8 command, u32 value);

/* Switches as they were set. */
u8 command_raw(void);
u8 command_uart(void);

#endif
