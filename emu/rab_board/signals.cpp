// Ranges: 12-bit ADC counts over the analog supply (range-and-bearing fact sheet 1.5, 4.3).

#include "emu/rab_board/signals.h"

#include "emu/rab_board/board.h"

#include <fmt/format.h>

#include <vector>

namespace puckloop::rab {

namespace {

using cosim::SignalDirection;
using cosim::SignalInfo;

constexpr double kFullScale = 4095;
constexpr double kHighestCarrier = 100e6;  // Hz
constexpr double kHighestCode = 255;
constexpr double kHighestBattery = 5;    // V
constexpr double kChargedBattery = 3.9;  // V, as on the main board

std::vector<SignalInfo> build() {
    std::vector<SignalInfo> list;
    const auto twelve = [&](const char* name, SignalDirection direction, const char* unit, double max,
                            const char* text) {
        for (int i = 1; i <= kSensorCount; ++i)
            list.push_back({fmt::format("{}{}", name, i), direction, unit, 0, max, text});
    };
    const auto output = [&](const char* name, const char* unit, double max, const char* text,
                            double initial = 0) {
        list.push_back({name, SignalDirection::Output, unit, 0, max, text, initial});
    };
    twelve("demod", SignalDirection::Input, "level", 1, "1 = demodulator sees carrier (its pin is 0)");
    twelve("peak", SignalDirection::Input, "counts", kFullScale, "level at the peak detector's input");
    twelve("emitter", SignalDirection::Output, "level", 1, "1 = carrier on");
    output("carrier", "Hz", kHighestCarrier, "frequency at OC1, 0 = off");
    output("power", "code", kHighestCode, "byte in the potentiometer, 0 = strongest", kPowerAtPowerOn);
    output("led", "level", 1, "level at the LED's pin");
    twelve("peak_reset", SignalDirection::Output, "level", 1, "1 = peak detector is being discharged");
    const auto volts = [&](const char* name, double max, double initial, const char* text) {
        list.push_back({name, SignalDirection::Input, "V", 0, max, text, initial});
    };
    volts("battery_v", kHighestBattery, kChargedBattery, "voltage of the robot's battery");
    volts("vdd", kRegulatedVolts, kRegulatedVolts, "supply of the chip at most, under a load or a short");
    return list;
}

}  // namespace

std::span<const SignalInfo> signals() {
    static const std::vector<SignalInfo> list = build();
    return list;
}

}  // namespace puckloop::rab
