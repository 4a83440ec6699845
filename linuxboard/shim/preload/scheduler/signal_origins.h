#pragma once
// Who sent a signal, as a handler reads it: numbers of the program's processes, and of an ended child its
// status.

#include <signal.h>
#include <sys/signalfd.h>

namespace puckloop::shim {

/// The next signal of this number is the node's: from another process of the program, or of a child's end.
/// And that it has been taken.
void expect_origin(int number);
void forget_origin(int number);
/// One that the host kept has been taken: whether it was such a signal.
bool take_origin(int number);
/// Who sent such a signal.
void show_origin(int number, siginfo_t& info);
/// The same in what a descriptor of signals gave (signalfd()).
void show_origin(signalfd_siginfo& record);

/// sigaction() of a signal whose handler may ask for the sender.
int set_informed_action(int number, const struct sigaction* next, struct sigaction* before);

}  // namespace puckloop::shim
