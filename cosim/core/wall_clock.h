#pragma once
// The host's time, for what is measured and how long is waited; nothing simulated depends on it.

#include <chrono>

namespace puckloop::cosim {

using WallClock = std::chrono::steady_clock;

inline double seconds_since(WallClock::time_point start) {
    return std::chrono::duration<double>(WallClock::now() - start).count();
}

}  // namespace puckloop::cosim
