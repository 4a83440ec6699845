#pragma once
// Which interrupt is first in line. A source requests while its flag and its enable bit are both set; the
// lowest vector wins. The core decides when to take it. Source: ATmega1284P data sheet (8272), "Reset and
// Interrupt Handling".

#include "emu/avr/device.h"

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
        const std::uint64_t bit = std::uint64_t{1} << vector;
        if (((requests_ & bit) != 0) == on) return;
        requests_ ^= bit;
        if (on && listener_) listener_(owner_);
    }

    bool any() const { return requests_ != 0; }
    /// One of the vectors in `mask` (bit n = vector n).
    bool any(std::uint64_t mask) const { return (requests_ & mask) != 0; }
    /// The vector that comes first; only if any().
    int first() const { return std::countr_zero(requests_); }
    void acknowledge(int vector) {
        const Source& source = sources_[static_cast<std::size_t>(vector)];
        if (source.acknowledge) source.acknowledge(source.owner, vector);
    }
    /// Called when a source begins to request.
    void set_listener(void* owner, void (*requested)(void* owner)) {
        owner_ = owner;
        listener_ = requested;
    }
    void reset() { requests_ = 0; }

    template <class Archive>
    void state(Archive& archive) {
        archive(requests_);
    }

  private:
    struct Source {
        void* owner = nullptr;
        Acknowledge acknowledge = nullptr;
    };
    std::uint64_t requests_ = 0;
    std::array<Source, 64> sources_{};
    void* owner_ = nullptr;
    void (*listener_)(void*) = nullptr;
};

}  // namespace puckloop::avr
