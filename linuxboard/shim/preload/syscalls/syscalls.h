#pragma once
// System calls by number: each table knows the calls of its kind for which there is a function that is taken
// over.

#include "linuxboard/shim/preload/syscalls/argument.h"

namespace puckloop::shim {

/// False if the call is none of the table's; else *result is what syscall() returns, -1 with errno on
/// failure.
bool futex_syscall(const Argument (&a)[6], long* result);
bool file_syscall(long number, const Argument (&a)[6], long* result);
bool path_syscall(long number, const Argument (&a)[6], long* result);
bool time_syscall(long number, const Argument (&a)[6], long* result);
bool signal_syscall(long number, const Argument (&a)[6], long* result);
bool process_syscall(long number, const Argument (&a)[6], long* result);

}  // namespace puckloop::shim
