#pragma once
// Work in a process of its own, which a crash of the emulator does not take the worker with.

#include "base/error.h"

#include <functional>

namespace puckloop::jobs {

/// The work crashed, or threw what nothing outside explains: a fault of the emulator itself.
class Broke : public RunError {
  public:
    using RunError::RunError;
};

/// A signal from outside ended it: of the user, of a machine without memory, of a limit. Tried again it may
/// do.
class Killed : public RunError {
  public:
    using RunError::RunError;
};

/// Calls `work` in a child process with no terminal, which ends with this one. What it throws comes back:
/// InputError as InputError, RunError and the lack of memory as RunError, anything else as Broke. A signal
/// from outside (SIGKILL, SIGTERM, ...) is a Killed, any other a Broke.
void run_isolated(const std::function<void()>& work);

}  // namespace puckloop::jobs
