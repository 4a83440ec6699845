#pragma once
// On which cores the processes of a run work.
//
// Where they take turns, as a board, its bus and its Linux program do byte for byte, waking a process on
// another core costs an interrupt there and the way out of idleness: several times a switch between processes
// on one core. Where they have work to do side by side, all cores are better. Which of the two holds shows
// only in how fast a run goes, so both are tried now and then. What is simulated does not depend on it.

#include "cosim/core/time.h"
#include "cosim/remote/processes/bell.h"
#include "cosim/schedule/trial.h"

#include <cstdint>

namespace puckloop::cosim {

/// The calling thread's share: follows what the run's conductor has chosen (cosim/core/cores.h).
class CoreFollower {
  public:
    explicit CoreFollower(const Busy& busy) : busy_(busy) {}
    /// The thread may use all cores again.
    ~CoreFollower();
    CoreFollower(const CoreFollower&) = delete;
    CoreFollower& operator=(const CoreFollower&) = delete;

    /// Costs next to nothing when nothing has changed.
    void follow() {
        if (const std::uint32_t core = busy_.core.load(std::memory_order_relaxed); core != core_) move(core);
    }

  private:
    void move(std::uint32_t core);

    const Busy& busy_;
    std::uint32_t core_ = kAnyCore;
};

/// The conductor's share: measures and chooses.
class CoreChoice {
  public:
    explicit CoreChoice(Busy& busy);

    /// To be called often: `wall` seconds after the run began it had reached `time` with so many grants.
    void step(double wall, Time time, std::uint64_t grants);

  private:
    void use(bool one_core);

    Busy& busy_;
    CoreFollower follower_;
    const bool worth_it_;
    Trial trial_;
    bool one_core_ = false;
};

}  // namespace puckloop::cosim
