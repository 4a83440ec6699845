#pragma once
// What a run's node processes share with the conductor, and how it waits for them all.

#include "cosim/core/cores.h"
#include "cosim/remote/processes/bell.h"
#include "cosim/remote/processes/core_choice.h"
#include "cosim/remote/processes/death_watch.h"
#include "cosim/remote/processes/ring.h"
#include "cosim/remote/processes/shared_memory.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::cosim {

/// Memory that every process of a run maps: the bell that the conductor waits at. It starts all zero.
struct SharedByRun {
    static constexpr const char* kName = "puckloop-run";
    BellState conductor;
    Busy busy;
};

/// Memory of one node process and the conductor. It starts all zero.
struct SharedWithNode {
    static constexpr const char* kName = "puckloop-node";
    RingState from_node;
    RingState to_node;
    BellState node;
};

/// One a run, in the conductor's process.
class NodeProcesses {
  public:
    /// Throws RunError.
    NodeProcesses();

    /// What a node process maps beside its own memory.
    int descriptor() const { return memory_.descriptor(); }
    Busy& busy() { return shared_.busy; }
    /// Where the conductor waits.
    Bell& bell() { return bell_; }
    DeathWatch& deaths() { return deaths_; }

    CoreChoice& cores() { return choice_; }

    std::uint32_t rings() const { return bell_.rings(); }
    /// After `out` granted nodes were looked at, none of which had answered since `seen` was read from
    /// rings(): waits until so many have answered that a core is free, until one has died, or some tenths of
    /// a second.
    void await_answers(std::uint32_t seen, std::size_t out);

  private:
    SharedMemory memory_;
    SharedByRun& shared_;
    Bell bell_;
    CoreChoice choice_;
    DeathWatch deaths_;
    const std::size_t cores_ = usable_cores();
};

}  // namespace puckloop::cosim
