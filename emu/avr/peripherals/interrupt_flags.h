#pragma once
// A flag register and its mask register, TIFRn and TIMSKn for example: a flag is cleared by writing a one to
// it or by entering its interrupt routine; flag and mask bit together request.

#include "emu/avr/peripherals/surroundings.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace puckloop::avr {

class InterruptFlags {
  public:
    struct Setup {
        std::uint16_t flags = 0;  ///< data address of the flag register
        std::uint16_t masks = 0;
        std::array<std::int8_t, 8> vectors{-1, -1, -1, -1, -1, -1, -1, -1};  ///< by bit
    };
    /// Called before each access and after each change: the owner brings flags up to date and plans its next
    /// event.
    using Touched = void (*)(void* owner);

    InterruptFlags(const Surroundings& around, const Setup& setup, void* owner = nullptr,
                   Touched touched = nullptr)
        : around_(around), setup_(setup), owner_(owner), touched_(touched) {
        around_.io.hook(setup.flags, this, &read_flags, &write_flags);
        around_.io.hook(setup.masks, this, nullptr, &write_masks);
        for (const std::int8_t vector : setup.vectors)
            if (vector >= 0) around_.interrupts.connect(vector, this, &acknowledge);
    }
    InterruptFlags(const InterruptFlags&) = delete;
    InterruptFlags& operator=(const InterruptFlags&) = delete;

    /// `next_change`: from when on a read of the flags may give something else, without an access or event.
    void follow(Cycle (*next_change)(void* owner)) {
        next_change_ = next_change;
        around_.io.set_follow(setup_.flags, &follow_flags);
    }

    std::uint8_t flags() const { return around_.io.raw(setup_.flags); }
    std::uint8_t masks() const { return around_.io.raw(setup_.masks); }
    /// Flags whose rising somebody waits for, enabled as interrupts or not.
    std::uint8_t watched() const { return watched_; }
    /// `rose` is called when one of these rises; the owner is touched, and plans accordingly (unless a saved
    /// state was loaded that has it planned).
    void watch(std::uint8_t bits, void* watcher, void (*rose)(void* watcher), bool plan) {
        if (bits == watched_) return;
        if (plan) touch();
        watched_ = bits;
        watcher_ = watcher;
        rose_ = rose;
        if (plan) touch();
    }
    void raise(std::uint8_t bits) {
        const auto rising = static_cast<std::uint8_t>(bits & ~flags());
        around_.io.raw(setup_.flags) |= bits;
        update();
        if (rising & watched_) rose_(watcher_);
    }
    void clear(std::uint8_t bits) {
        around_.io.raw(setup_.flags) &= static_cast<std::uint8_t>(~bits);
        update();
    }
    /// Requests follow flags and masks.
    void update() {
        for (int i = 0; i < 8; ++i)
            if (const int vector = setup_.vectors[static_cast<std::size_t>(i)]; vector >= 0)
                around_.interrupts.request(vector, flags() & masks() & bit(i));
    }

  private:
    void touch() const {
        if (touched_) touched_(owner_);
    }
    static std::uint8_t read_flags(void* owner, std::uint16_t) {
        const auto& self = *static_cast<InterruptFlags*>(owner);
        self.touch();
        return self.flags();
    }
    static std::size_t follow_flags(void* owner, std::uint16_t, Cycle first, Cycle period,
                                    std::span<std::uint8_t> values) {
        const auto& self = *static_cast<InterruptFlags*>(owner);
        const Cycle change = self.next_change_(self.owner_);
        if (first >= change) return 0;
        std::fill(values.begin(), values.end(), self.flags());
        if (period == 0) return values.size();
        return static_cast<std::size_t>(
            std::min<Cycle>(values.size(), (change - first + period - 1) / period));
    }
    static void write_flags(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
        auto& self = *static_cast<InterruptFlags*>(owner);
        self.touch();
        self.clear(value & mask);
        self.touch();
    }
    static void write_masks(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
        auto& self = *static_cast<InterruptFlags*>(owner);
        self.touch();
        self.around_.io.store(address, value, mask);
        self.update();
        self.touch();
    }
    static void acknowledge(void* owner, int vector) {
        auto& self = *static_cast<InterruptFlags*>(owner);
        for (int i = 0; i < 8; ++i)
            if (self.setup_.vectors[static_cast<std::size_t>(i)] == vector) self.clear(bit(i));
        self.touch();
    }

    Surroundings around_;
    Setup setup_;
    void* owner_;
    Touched touched_;
    Cycle (*next_change_)(void*) = nullptr;
    std::uint8_t watched_ = 0;
    void* watcher_ = nullptr;
    void (*rose_)(void*) = nullptr;
};

}  // namespace puckloop::avr
