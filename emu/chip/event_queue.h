#pragma once
// The chip's timetable: each peripheral owns a few slots and says at which cycle it next has something to do.

#include <array>
#include <cstdint>
#include <limits>

namespace puckloop::chip {

/// Instruction cycles (clocks, on an AVR) since power-up. Never goes back, not even at a reset.
using Cycle = std::uint64_t;
inline constexpr Cycle kNoCycle = std::numeric_limits<Cycle>::max();

/// Peripherals compute their next event; they never tick. The core runs freely until next().
///
/// Slots are the leaves of a tournament: each inner place holds the earlier one of the two below it, the
/// lower slot at equal cycles, so that finding the next event costs one walk from a leaf to the top.
class EventQueue {
  public:
    /// `due` is the cycle that was asked for; it may lie a few cycles before the core's present one, because
    /// an instruction is never cut in two.
    using Handler = void (*)(void* owner, Cycle due);
    using Slot = std::uint8_t;

    /// An event that comes every `period` cycles and does nothing but raise `irq`, until changed.
    struct Steady {
        int irq = -1;  ///< -1: the slot's event is not of this kind
        Cycle period = 0;
        /// Does in one go what `times` events do, the flag that they raise left out; the first was due.
        void (*pass)(void* owner, std::uint64_t times) = nullptr;
    };

    Slot add(void* owner, Handler handler);
    void schedule(Slot slot, Cycle due) {
        if (due_[slot] == due) return;
        if (under_way_ != kNone && under_way_ != slot) play(under_way_);
        due_[slot] = due;
        play(slot);
    }
    void cancel(Slot slot) { schedule(slot, kNoCycle); }
    Cycle due(Slot slot) const { return due_[slot]; }

    Cycle next() const { return next_; }
    /// The slot whose event is next(), if there is one.
    Slot next_slot() const { return winners_[1]; }
    /// The first event of all other slots.
    Cycle next_except(Slot slot) const {
        Cycle first = kNoCycle;
        for (unsigned place = kCapacity + slot; place > 1; place /= 2) {
            const Cycle beside = due_[winner(place ^ 1u)];
            if (beside < first) first = beside;
        }
        return first;
    }
    void set_steady(Slot slot, const Steady& steady) { steady_[slot] = steady; }
    const Steady& steady(Slot slot) const { return steady_[slot]; }
    void pass(Slot slot, std::uint64_t times) { steady_[slot].pass(handlers_[slot].owner, times); }
    /// Runs every handler due at or before `now`, by due cycle, then by slot. Handlers may schedule again.
    void service(Cycle now) {
        if (under_way_ != kNone) play(under_way_);  // its handler threw
        while (next_ <= now) {
            const Slot slot = winners_[1];
            const Cycle due = next_;
            // Most handlers schedule their slot again: the tournament is played once, then or afterwards.
            due_[slot] = kNoCycle;
            under_way_ = slot;
            handlers_[slot].call(handlers_[slot].owner, due);
            if (under_way_ == slot) play(slot);
        }
    }

    /// Due times by slot; who owns the slots and what is steady about them follows from the chip.
    template <class Archive>
    void state(Archive& archive) {
        for (unsigned slot = 0; slot < size_; ++slot) {
            Cycle due = due_[slot];
            archive(due);
            if constexpr (Archive::kLoads) schedule(static_cast<Slot>(slot), due);
        }
    }

  private:
    static constexpr unsigned kCapacity = 64;
    static constexpr Slot kNone = 0xFF;
    struct Entry {
        Handler call = nullptr;
        void* owner = nullptr;
    };
    Slot winner(unsigned place) const {
        return place < kCapacity ? winners_[place] : static_cast<Slot>(place - kCapacity);
    }

    void play(Slot slot) {
        under_way_ = kNone;
        for (unsigned place = (kCapacity + slot) / 2; place; place /= 2) {
            const Slot left = winner(2 * place);
            const Slot right = winner(2 * place + 1);
            const Slot first = due_[right] < due_[left] ? right : left;
            // Another one won here before, too: nothing changes above.
            if (first == winners_[place] && first != slot) break;
            winners_[place] = first;
        }
        next_ = due_[winners_[1]];
    }

    std::array<Cycle, kCapacity> due_ = never();
    std::array<Slot, kCapacity> winners_ = first_slots();  ///< of inner places, 1 = the top
    std::array<Entry, kCapacity> handlers_{};
    std::array<Steady, kCapacity> steady_{};
    unsigned size_ = 0;
    Slot under_way_ = kNone;  ///< its handler runs, and its place in the tournament is not settled
    Cycle next_ = kNoCycle;

    static constexpr std::array<Cycle, kCapacity> never() {
        std::array<Cycle, kCapacity> cycles{};
        cycles.fill(kNoCycle);
        return cycles;
    }
    static constexpr std::array<Slot, kCapacity> first_slots() {
        std::array<Slot, kCapacity> slots{};
        for (unsigned place = kCapacity - 1; place > 0; --place)
            slots[place] =
                2 * place < kCapacity ? slots[2 * place] : static_cast<Slot>(2 * place - kCapacity);
        return slots;
    }
};

}  // namespace puckloop::chip
