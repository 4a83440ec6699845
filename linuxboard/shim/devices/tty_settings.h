#pragma once
// termios as numbers: what a UART needs to know of it.

#include "cosim/core/time.h"
#include "protocols/serial/uart_sampling.h"

#include <termios.h>

namespace puckloop::linuxboard {

/// The settings of a freshly opened serial port: 9600 8N1, canonical mode, echo, as the Linux tty layer
/// starts them.
termios initial_termios();

/// Bits per second of the output speed; 0 for B0 (hang up) and for speeds that Linux does not know.
int baud_rate(speed_t speed);

/// Picoseconds a bit, `ppm` being the error of the board's clock (+ is fast). B0 is 9600, as in Linux's
/// driver.
cosim::Time bit_period(const termios& settings, double ppm);

/// Data bits, parity and bit period a receiver with these settings uses.
protocols::UartReceiver receiver_of(const termios& settings, double ppm);

}  // namespace puckloop::linuxboard
