#pragma once
// Numbers of processes: the program has its own, from wire::kFirstProcess on; the host has others. A number
// that is none of the program's reaches nobody: the host's processes are out of reach.

#include <sys/types.h>

namespace puckloop::shim {

/// The host's number for a process of the program; 0 (the caller) stays. -1 with errno ESRCH for any other
/// number. Where nothing is conducted it is `given`.
pid_t host_process(pid_t given);
/// The reverse; 0 for a process that is none of the program's.
pid_t program_process(pid_t host);

/// A signal for one thread, by the number that gettid() gives; `process` -1: whichever has it. 0, or -1 with
/// errno ESRCH or EINVAL.
int signal_thread(pid_t process, pid_t thread, int number);

}  // namespace puckloop::shim
