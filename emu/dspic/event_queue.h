#pragma once
// The chip's timetable: each peripheral owns a few slots and says at which cycle it next has something to do.

#include <array>
#include <cstdint>
#include <limits>

namespace puckloop::dspic {

/// Instruction cycles (TCY) since power-up. Never goes back, not even at a reset.
using Cycle = std::uint64_t;
inline constexpr Cycle kNoCycle = std::numeric_limits<Cycle>::max();

/// Peripherals compute their next event; they never tick. The core runs freely until next().
class EventQueue {
  public:
    /// `due` is the cycle that was asked for; it may lie a few cycles before the core's present one, because
    /// an instruction is never cut in two.
    using Handler = void (*)(void* owner, Cycle due);
    using Slot = std::uint8_t;

    Slot add(void* owner, Handler handler);
    void schedule(Slot slot, Cycle due);
    void cancel(Slot slot) { schedule(slot, kNoCycle); }
    Cycle due(Slot slot) const { return entries_[slot].due; }

    Cycle next() const { return next_; }
    /// Runs every handler due at or before `now`, by due cycle, then by slot. Handlers may schedule again.
    void service(Cycle now);

  private:
    struct Entry {
        Cycle due = kNoCycle;
        Handler handler = nullptr;
        void* owner = nullptr;
    };
    void find_next();

    static constexpr int kCapacity = 64;
    std::array<Entry, kCapacity> entries_{};
    int size_ = 0;
    Cycle next_ = kNoCycle;
};

}  // namespace puckloop::dspic
