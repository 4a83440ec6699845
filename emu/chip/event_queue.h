#pragma once
// The chip's timetable: each peripheral owns a few slots and states at which cycle it next has something to
// do.

#include <array>
#include <cstdint>
#include <limits>

namespace puckloop::chip {

/// Instruction cycles (clocks, on an AVR) since power-up. Never goes back, not even at a reset.
using Cycle = std::uint64_t;
inline constexpr Cycle kNoCycle = std::numeric_limits<Cycle>::max();

/// Peripherals compute their next event; they never tick. The core runs freely until next().
///
/// A slot's key is its due cycle with its number behind it, so that the least key is the next event, the
/// lower slot at equal cycles; the least ones of groups of eight are kept.
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
        if (under_way_ != kNone && under_way_ != slot) settle(under_way_);
        due_[slot] = due;
        settle(slot);
    }
    void cancel(Slot slot) { schedule(slot, kNoCycle); }
    Cycle due(Slot slot) const { return due_[slot]; }

    Cycle next() const { return next_; }
    /// The slot whose event is next(), if there is one.
    Slot next_slot() const { return slot_of(first_); }
    /// The first event of all other slots.
    Cycle next_except(Slot slot) const {
        Cycle first = kNoCycle;
        for (unsigned other = 0; other < size_; ++other)
            if (other != slot && due_[other] < first) first = due_[other];
        return first;
    }
    void set_steady(Slot slot, const Steady& steady) { steady_[slot] = steady; }
    const Steady& steady(Slot slot) const { return steady_[slot]; }
    void pass(Slot slot, std::uint64_t times) { steady_[slot].pass(handlers_[slot].owner, times); }
    /// Runs every handler due at or before `now`, by due cycle, then by slot. Handlers may schedule again.
    void service(Cycle now) {
        if (under_way_ != kNone) settle(under_way_);  // its handler threw
        while (next_ <= now) {
            const Slot slot = next_slot();
            const Cycle due = next_;
            // Most handlers schedule their slot again: what is first is found once, then or afterwards.
            due_[slot] = kNoCycle;
            under_way_ = slot;
            handlers_[slot].call(handlers_[slot].owner, due);
            if (under_way_ == slot) settle(slot);
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
    static constexpr unsigned kSlotBits = 6;
    static constexpr unsigned kCapacity = 1u << kSlotBits;
    static constexpr unsigned kGroup = 8;
    using Key = std::uint64_t;
    static constexpr Slot kNone = 0xFF;
    struct Entry {
        Handler call = nullptr;
        void* owner = nullptr;
    };
    static constexpr Key key(Slot slot, Cycle due) {
        constexpr Cycle kFarthest = kNoCycle >> kSlotBits;
        return (due < kFarthest ? due : kFarthest) << kSlotBits | slot;
    }
    static Slot slot_of(Key key) { return static_cast<Slot>(key % kCapacity); }
    static Key least(const Key* keys) {
        const auto first = [](Key a, Key b) { return b < a ? b : a; };
        return first(first(first(keys[0], keys[1]), first(keys[2], keys[3])),
                     first(first(keys[4], keys[5]), first(keys[6], keys[7])));
    }
    void settle(Slot slot) {
        under_way_ = kNone;
        keys_[slot] = key(slot, due_[slot]);
        const unsigned group = slot / kGroup;
        firsts_[group] = least(&keys_[group * kGroup]);
        first_ = least(firsts_.data());
        next_ = due_[slot_of(first_)];
    }

    std::array<Cycle, kCapacity> due_ = never();
    std::array<Key, kCapacity> keys_ = no_keys();
    std::array<Key, kCapacity / kGroup> firsts_ = no_firsts();
    Key first_ = key(0, kNoCycle);
    std::array<Entry, kCapacity> handlers_{};
    std::array<Steady, kCapacity> steady_{};
    unsigned size_ = 0;
    Slot under_way_ = kNone;  ///< its handler runs, and what is first is not settled
    Cycle next_ = kNoCycle;

    static constexpr std::array<Cycle, kCapacity> never() {
        std::array<Cycle, kCapacity> cycles{};
        cycles.fill(kNoCycle);
        return cycles;
    }
    static constexpr std::array<Key, kCapacity> no_keys() {
        std::array<Key, kCapacity> keys{};
        for (unsigned slot = 0; slot < kCapacity; ++slot)
            keys[slot] = key(static_cast<Slot>(slot), kNoCycle);
        return keys;
    }
    static constexpr std::array<Key, kCapacity / kGroup> no_firsts() {
        std::array<Key, kCapacity / kGroup> keys{};
        for (unsigned group = 0; group < kCapacity / kGroup; ++group)
            keys[group] = key(static_cast<Slot>(group * kGroup), kNoCycle);
        return keys;
    }
};

}  // namespace puckloop::chip
