#include "cosim/clock.h"

#include <cmath>

namespace puckloop::cosim {

namespace {
__extension__ using Wide = unsigned __int128;
// Picoseconds in a second times microhertz in a hertz.
constexpr Wide kScale = static_cast<Wide>(1'000'000'000'000u) * 1'000'000u;
}  // namespace

ClockDomain::ClockDomain(double hertz, double ppm) : ppm_(ppm) {
    set_rate(hertz);
}

void ClockDomain::set_rate(double hertz) {
    hertz_ = hertz;
    microhertz_ = static_cast<std::uint64_t>(std::llround(hertz * (1.0 + ppm_ * 1e-6) * 1e6));
}

Time ClockDomain::time_of(std::uint64_t cycle) const {
    return base_time_ + static_cast<Time>((cycle - base_cycle_) * kScale / microhertz_);
}

std::uint64_t ClockDomain::first_cycle_at(Time time) const {
    if (time <= base_time_) return base_cycle_;
    const Wide product = static_cast<Wide>(time - base_time_) * microhertz_;
    // time_of() rounds down, so the smallest n with floor(n*kScale/f) >= dt is ceil(dt*f/kScale).
    return base_cycle_ + static_cast<std::uint64_t>((product + kScale - 1) / kScale);
}

void ClockDomain::change_rate(std::uint64_t cycle, double hertz) {
    base_time_ = time_of(cycle);
    base_cycle_ = cycle;
    set_rate(hertz);
}

}  // namespace puckloop::cosim
