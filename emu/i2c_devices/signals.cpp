#include "emu/i2c_devices/signals.h"

#include <fmt/format.h>

#include <vector>

namespace puckloop::i2c_devices {

namespace {

using cosim::SignalDirection;
using cosim::SignalInfo;

std::vector<SignalInfo> build() {
    constexpr double kTenBits = 1023;
    constexpr double kByte = 255;
    std::vector<SignalInfo> list;
    const char* const sides[] = {"left", "centre", "right"};
    for (int i = 0; i < 3; ++i)
        list.push_back({fmt::format("ground{}", i), SignalDirection::Input, "counts", 0, kTenBits,
                        fmt::format("ground sensor {}, emitter on", sides[i]), 0});
    for (int i = 0; i < 3; ++i)
        list.push_back({fmt::format("ground_ambient{}", i), SignalDirection::Input, "counts", 0, kTenBits,
                        fmt::format("ground sensor {}, emitter off", sides[i]), 0});
    for (int led = 0; led < 3; ++led)
        for (const char* const colour : {"red", "green", "blue"})
            list.push_back({fmt::format("rgb{}_{}", led, colour), SignalDirection::Output, "level", 0, kByte,
                            fmt::format("RGB turret, LED {}", led), 0});
    constexpr double kMostG = 24, kMostDegrees = 5000;
    const char* const axes[] = {"x (forward)", "y (left)", "z (up)"};
    for (int i = 0; i < 3; ++i)
        list.push_back({fmt::format("lsm330_acc_{}", axes[i][0]), SignalDirection::Input, "g", -kMostG,
                        kMostG, fmt::format("acceleration less gravity along {}; at rest z is 1", axes[i]),
                        i == 2 ? 1.0 : 0.0});
    for (int i = 0; i < 3; ++i)
        list.push_back({fmt::format("lsm330_rate_{}", axes[i][0]), SignalDirection::Input, "deg/s",
                        -kMostDegrees, kMostDegrees, fmt::format("turn rate about {}", axes[i]), 0});
    return list;
}

}  // namespace

std::span<const SignalInfo> signals() {
    static const std::vector<SignalInfo> list = build();
    return list;
}

}  // namespace puckloop::i2c_devices
