#include "cosim/core/clock.h"

#include <cmath>

namespace puckloop::cosim {

namespace {
__extension__ using Wide = unsigned __int128;
// Picoseconds in a second times microhertz in a hertz.
constexpr Wide kScale = static_cast<Wide>(1'000'000'000'000u) * 1'000'000u;
constexpr double kScaleAbout = 1e18;
// Below, a double is off by some units at most.
constexpr double kNear = 0x1.0p53;

/// floor(product / divisor), given about what it is: a division of such numbers takes many times as long as
/// to multiply them.
std::uint64_t quotient(Wide product, std::uint64_t divisor, double about) {
    if (!(about < kNear)) return static_cast<std::uint64_t>(product / divisor);
    auto guess = static_cast<std::uint64_t>(about);
    while (static_cast<Wide>(guess) * divisor > product)
        --guess;
    while (static_cast<Wide>(guess + 1) * divisor <= product)
        ++guess;
    return guess;
}
}  // namespace

std::uint64_t ClockDomain::effective_microhertz(double hertz) const {
    return static_cast<std::uint64_t>(std::llround(hertz * (1.0 + ppm_ * 1e-6) * 1e6));
}

ClockDomain::ClockDomain(double hertz, double ppm)
    : hertz_(hertz), ppm_(ppm), present_{0, 0, effective_microhertz(hertz)} {}

Time ClockDomain::Stretch::time_of(std::uint64_t later_cycle) const {
    const std::uint64_t cycles = later_cycle - cycle;
    const double about = static_cast<double>(cycles) * kScaleAbout / static_cast<double>(microhertz);
    return time + static_cast<Time>(quotient(cycles * kScale, microhertz, about));
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
    const Time span = time - present_.time;
    const Wide product = static_cast<Wide>(span) * present_.microhertz;
    const double about = static_cast<double>(span) * static_cast<double>(present_.microhertz) / kScaleAbout;
    // time_of() rounds down, so the smallest n with floor(n*kScale/f) >= dt is ceil(dt*f/kScale).
    return present_.cycle + quotient(product + kScale - 1, kScale, about);
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
