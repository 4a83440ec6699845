#pragma once
// System calls that a program makes by an instruction of its own, past the C library.

namespace puckloop::shim {

/// Once a process: programs find no clock that they could read without a call. To be called before the first
/// conduct_direct_syscalls().
void prepare_direct_syscalls();
/// From now on this thread's system calls from outside of the C library are those of syscall(). Each thread,
/// and each new process, asks for itself. Where the kernel cannot (before 5.11, or not x86-64) nothing
/// changes.
void conduct_direct_syscalls();

}  // namespace puckloop::shim
