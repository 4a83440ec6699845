#include "emu/avr/peripherals/timing/watch_clock.h"

namespace puckloop::avr {

namespace {
constexpr Cycle kSynchroniser = 3;
}

std::uint64_t WatchClock::edges(Cycle at) const {
    if (pin_) return pin_edges_;
    if (at < kSynchroniser) return 0;
    const auto time = static_cast<std::uint64_t>(clock_.time_of(at - kSynchroniser));
    constexpr auto kSecond = static_cast<std::uint64_t>(cosim::kSecond);
    return time / kSecond * hertz_ + time % kSecond * hertz_ / kSecond;
}

Cycle WatchClock::edge(std::uint64_t n) const {
    if (pin_ || !fitted()) return kNoCycle;
    constexpr auto kSecond = static_cast<std::uint64_t>(cosim::kSecond);
    const std::uint64_t time = n / hertz_ * kSecond + (n % hertz_ * kSecond + hertz_ - 1) / hertz_;
    return clock_.first_cycle_at(static_cast<cosim::Time>(time)) + kSynchroniser;
}

}  // namespace puckloop::avr
