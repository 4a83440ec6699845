#pragma once
// Ctrl-C, SIGTERM and SIGHUP as a flag that a run looks at, so that everything recorded is flushed.

#include <csignal>

namespace puckloop::cosim {

/// While one lives, the signals set its flag in place of killing; a second one of the same kind kills.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    /// For RunOptions::interrupted.
    const volatile std::sig_atomic_t* flag() const;

  private:
    struct sigaction before_[3];
};

}  // namespace puckloop::cosim
