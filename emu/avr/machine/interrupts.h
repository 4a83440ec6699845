#pragma once
// Which interrupt is first in line. A source requests while its flag and its enable bit are both set; the
// lowest vector wins. The core decides when to take it. Source: ATmega1284P data sheet (8272), "Reset and
// Interrupt Handling".

#include "emu/avr/devices/device.h"

#include <array>
#include <bit>
#include <cstdint>

namespace puckloop::avr {

class InterruptController {
  public:
    /// What happens to the source's flag when its routine is entered; null: the routine clears it.
    using Acknowledge = void (*)(void* owner, int vector);

    void connect(int vector, void* owner, Acknowledge acknowledge) {
        sources_[static_cast<std::size_t>(vector)] = {owner, acknowledge};
    }
    /// Flag and enable bit of `vector` are both set, or no longer are.
    void request(int vector, bool on) {
        const std::uint64_t bit = bit_of(vector);
        if (((wanted_ & bit) != 0) == on) return;
        wanted_ ^= bit;
        if (gated_ & bit) [[unlikely]] {
            held_ &= ~bit;
            if (on && !gate_(gate_owner_, vector)) held_ |= bit;
        }
        show();
    }
    /// A source whose request was not over yet has something new to report.
    void again(int vector) {
        const std::uint64_t bit = bit_of(vector);
        if ((wanted_ & held_ & bit) == 0 || !gate_(gate_owner_, vector)) return;
        release(vector);
    }
    /// One request out of nowhere, whatever flag and enable bit are.
    void force(int vector) {
        forced_ |= bit_of(vector);
        show();
    }
    /// Asks `passes` at every request that begins of the sources in `vectors` (bit n = vector n); false: it
    /// is held until it is over, or release().
    void set_gate(void* owner, bool (*passes)(void* owner, int vector), std::uint64_t vectors) {
        gate_owner_ = owner;
        gate_ = passes;
        gated_ = vectors;
    }
    void release(int vector) {
        held_ &= ~bit_of(vector);
        show();
    }
    /// A request that is held is over without its routine, if it is the routine's entry that clears the flag.
    void lose(int vector) {
        const Source& source = sources_[static_cast<std::size_t>(vector)];
        if ((held_ & bit_of(vector)) != 0 && source.acknowledge) source.acknowledge(source.owner, vector);
    }

    bool any() const { return requests_ != 0; }
    /// One of the vectors in `mask` (bit n = vector n).
    bool any(std::uint64_t mask) const { return (requests_ & mask) != 0; }
    /// The vector that comes first; only if any().
    int first() const { return std::countr_zero(requests_); }
    void acknowledge(int vector) {
        if (forced_ & bit_of(vector)) {
            forced_ &= ~bit_of(vector);
            show();
        }
        const Source& source = sources_[static_cast<std::size_t>(vector)];
        if (source.acknowledge) source.acknowledge(source.owner, vector);
    }
    /// Called when a source begins to request.
    void set_listener(void* owner, void (*requested)(void* owner)) {
        owner_ = owner;
        listener_ = requested;
    }
    void reset() { requests_ = wanted_ = held_ = forced_ = 0; }

    template <class Archive>
    void state(Archive& archive) {
        archive(requests_, wanted_, held_, forced_);
    }

  private:
    struct Source {
        void* owner = nullptr;
        Acknowledge acknowledge = nullptr;
    };
    static constexpr std::uint64_t bit_of(int vector) { return std::uint64_t{1} << vector; }
    void show() {
        const std::uint64_t before = requests_;
        requests_ = (wanted_ & ~held_) | forced_;
        if ((requests_ & ~before) != 0 && listener_) listener_(owner_);
    }

    std::uint64_t requests_ = 0;  ///< what the core sees; bit n is vector n
    std::uint64_t wanted_ = 0;    ///< flag and enable bit are set
    std::uint64_t held_ = 0;      ///< a fault keeps them back
    std::uint64_t forced_ = 0;
    std::uint64_t gated_ = 0;
    void* gate_owner_ = nullptr;
    bool (*gate_)(void*, int) = nullptr;
    std::array<Source, 64> sources_{};
    void* owner_ = nullptr;
    void (*listener_)(void*) = nullptr;
};

}  // namespace puckloop::avr
