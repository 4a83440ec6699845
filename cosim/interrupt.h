#pragma once
// Ctrl-C, SIGTERM and SIGHUP as a flag that a run looks at, so that everything recorded is flushed.

#include <csignal>

namespace puckloop::cosim {

/// While one lives, the first signal sets flag() and a second one again(), in place of killing; a third
/// kills.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    /// For RunOptions::interrupted: the number of the first signal, 0 before.
    const volatile std::sig_atomic_t* flag() const;
    /// For RunOptions::abort_requested.
    const volatile std::sig_atomic_t* again() const;

  private:
    struct sigaction before_[3];
};

}  // namespace puckloop::cosim
