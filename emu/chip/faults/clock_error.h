#pragma once
// Another error of a chip's clock while it runs.

#include "cosim/core/clock.h"

#include <string_view>
#include <type_traits>

namespace puckloop::chip {

namespace clock_error_detail {

/// Goes through what a clock domain remembers, as an archive does, and replaces the second number, its error.
struct SetPpm {
    static constexpr bool kLoads = false, kRaw = true;
    double ppm = 0.0;
    int number = 0;

    template <class T>
    void bounded(T& value, std::type_identity_t<T>, std::type_identity_t<T>) {
        if (++number == 2) value = ppm;
    }
    template <class... T>
    void operator()(T&...) {}
    template <class T>
    void grows(T&) {}
    void check(bool, std::string_view) {}
};

}  // namespace clock_error_detail

/// From cycle `cycle` on the domain is off by `ppm` in place of what it was; its nominal rate stays.
inline void change_ppm(cosim::ClockDomain& clock, std::uint64_t cycle, double ppm) {
    clock_error_detail::SetPpm setter{ppm};
    clock.state(setter);
    clock.change_rate(cycle, clock.hertz());
}

}  // namespace puckloop::chip
