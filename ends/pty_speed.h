#pragma once
// The baud rate in a terminal's settings, any number: what a pty carries of a serial port's settings besides
// the number of stop bits. (The kernel forces 8 data bits without parity on a pty; it has no DTR, RTS or
// other modem lines, and drops breaks.)

#include <optional>

namespace puckloop::exec {

/// 0 after B0, "hang up"; nothing if `terminal` (a file descriptor, of either end) has no settings.
std::optional<double> terminal_baud(int terminal);
/// 8 bits, raw, both directions at `baud`. False if it could not be set (errno gives the reason).
bool set_raw_terminal(int terminal, double baud);

}  // namespace puckloop::exec
