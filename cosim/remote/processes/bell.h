#pragma once
// How one process waits for others through shared memory: a count that every ring raises, and a futex on it.
//
// A wait looks again for a moment before it sleeps, because an answer often takes less time than putting a
// process to sleep and waking it. That is worth a core only if one is free: a run's processes keep count of
// how many of them work, and nobody looks while more of them do than there are cores. Where looking did not
// help, it is left out for a while, twice as long each time.

#include <atomic>
#include <chrono>
#include <cstdint>

namespace puckloop::cosim {

/// In shared memory; all zero at first. Nothing read here is trusted for more than when to look and to wake.
struct alignas(64) BellState {
    std::atomic<std::uint32_t> rings;
    std::atomic<std::uint32_t> wake_at;  ///< count that the sleeper waits for
    std::atomic<std::uint32_t> asleep;   ///< 1: to be woken by whoever takes this to 0
};

inline constexpr std::uint32_t kAnyCore = 0;

/// In shared memory, one a run: how many of its processes work or look, and on which core; kAnyCore or its
/// number plus 1 (core_choice.h).
struct alignas(64) Busy {
    std::atomic<std::uint32_t> processes;
    std::atomic<std::uint32_t> core;
};

/// One process's view of a bell. Any number of processes ring it; one waits at it.
class Bell {
  public:
    Bell(BellState& state, Busy& busy);

    std::uint32_t rings() const { return state_.rings.load(std::memory_order_seq_cst); }
    /// Something was written that the one who waits should see. `at_once`: even if it waits for more rings.
    void ring(bool at_once = false);
    /// Until the count is `more` (at least 1) beyond `seen`, somebody rings at once, `limit` of wall time is
    /// over or a signal comes. Whoever reads `seen` first and then what was written misses nothing.
    void wait(std::uint32_t seen, std::uint32_t more, std::chrono::nanoseconds limit);

  private:
    bool rung(std::uint32_t wake_at) const;
    bool crowded() const;
    bool look(std::uint32_t wake_at);
    void sleep(std::uint32_t wake_at, std::chrono::nanoseconds limit);

    BellState& state_;
    Busy& busy_;
    const std::uint32_t cores_;
    std::uint32_t in_vain_ = 0;  ///< looks in a row that did not help
    std::uint32_t skip_ = 0;     ///< waits to come without looking
};

}  // namespace puckloop::cosim
