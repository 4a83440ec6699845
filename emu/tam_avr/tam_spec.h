#pragma once
// A TAM's board as a run describes it.

#include "base/fields/field.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tam {

struct TamSpec {
    static constexpr std::string_view kKind = "tam";
    static constexpr double kAdcNoise = 0.5, kBattery = 3.7;
    static constexpr int kNetwork = 3;

    std::string name;
    std::string firmware;
    std::string boot_loader{};
    std::uint64_t seed = 1;
    double resonator_ppm = 0.0;
    double adc_noise = kAdcNoise;
    int network = kNetwork;
    double battery = kBattery;
    double start = 0.0;
    std::vector<double> resets{};
    std::string log{};
    bool pins_linked = false;
    bool ir_linked = false;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &TamSpec::name, "of the node").required().not_in(Comparison::State),
            field("firmware", &TamSpec::firmware, "file of the image").required().not_in(Comparison::State),
            field("boot_loader", &TamSpec::boot_loader, "file of its image; empty: none"),
            field("seed", &TamSpec::seed, "of the run"),
            field("resonator_ppm", &TamSpec::resonator_ppm, "error of the 16 MHz resonator, + is fast")
                .in("ppm"),
            field("adc_noise", &TamSpec::adc_noise, "standard deviation of the converter's noise")
                .in("counts")
                .within(0, 1000),
            field("network", &TamSpec::network, "DIP switches: the network is 01B2 and this").within(0, 3),
            field("battery_v", &TamSpec::battery, "voltage of the battery").in("V").within(0, 5),
            field("start_s", &TamSpec::start, "switched on").in("s").at_least(0),
            field("resets", &TamSpec::resets, "when the reset button is pressed, rising, after start_s")
                .in("s"),
            field("log", &TamSpec::log, "file for the board's log; empty: none").not_in(Comparison::State),
            field("pins_linked", &TamSpec::pins_linked, "a radio module hears of the pins")
                .not_in(Comparison::State),
            field("ir_linked", &TamSpec::ir_linked, "somebody sees the transceiver")
                .not_in(Comparison::State));
    }
};
static_assert(lists_all_fields<TamSpec>);

}  // namespace puckloop::tam
