#include "cosim/core/clock.h"

#include <cmath>

namespace puckloop::cosim {

namespace {
__extension__ using Wide = unsigned __int128;
// Picoseconds in a second times microhertz in a hertz.
constexpr Wide kScale = static_cast<Wide>(1'000'000'000'000u) * 1'000'000u;
}  // namespace

std::uint64_t ClockDomain::effective_microhertz(double hertz) const {
    return static_cast<std::uint64_t>(std::llround(hertz * (1.0 + ppm_ * 1e-6) * 1e6));
}

ClockDomain::ClockDomain(double hertz, double ppm)
    : hertz_(hertz), ppm_(ppm), present_{0, 0, effective_microhertz(hertz)} {}

Time ClockDomain::Stretch::time_of(std::uint64_t later_cycle) const {
    return time + static_cast<Time>((later_cycle - cycle) * kScale / microhertz);
}

Time ClockDomain::time_of(std::uint64_t cycle) const {
    if (cycle >= present_.cycle) return present_.time_of(cycle);
    auto stretch = past_.rbegin();
    while (stretch->cycle > cycle)
        ++stretch;  // the first stretch begins with cycle 0
    return stretch->time_of(cycle);
}

std::uint64_t ClockDomain::first_cycle_at(Time time) const {
    if (time <= present_.time) return present_.cycle;
    const Wide product = static_cast<Wide>(time - present_.time) * present_.microhertz;
    // time_of() rounds down, so the smallest n with floor(n*kScale/f) >= dt is ceil(dt*f/kScale).
    return present_.cycle + static_cast<std::uint64_t>((product + kScale - 1) / kScale);
}

void ClockDomain::change_rate(std::uint64_t cycle, double hertz) {
    const Stretch next{cycle, time_of(cycle), effective_microhertz(hertz)};
    past_.push_back(present_);
    present_ = next;
    hertz_ = hertz;
}

void ClockDomain::change_ppm(std::uint64_t cycle, double ppm) {
    ppm_ = ppm;
    change_rate(cycle, hertz_);
}

}  // namespace puckloop::cosim
