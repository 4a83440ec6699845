#pragma once
// The guard that a copy sets while it follows a pointer of the program.

#include <setjmp.h>

namespace puckloop::shim {

/// Where a fault of the calling thread goes on, or nullptr: the program's own handler has it.
sigjmp_buf* set_fault_guard(sigjmp_buf* guard);
/// Who makes the system call that SIGSYS reports, with the ucontext_t of its place.
void take_direct_calls(void (*handler)(void* context));

}  // namespace puckloop::shim
