#pragma once
// A range-and-bearing board as a run describes it.

#include "base/fields/field.h"
#include "emu/board/can_ports.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::rab {

struct RabSpec {
    static constexpr std::string_view kKind = "rab";
    static constexpr double kAdcNoise = 1.0;

    std::string name;
    std::string firmware;
    std::uint64_t seed = 1;
    double crystal_ppm = 0.0;
    double adc_noise = kAdcNoise;
    double i2c_hertz = 100e3;
    std::string nvm{};
    board::CanModules can = 0;
    std::string log{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &RabSpec::name, "of the node").required().not_in(Comparison::State),
            field("firmware", &RabSpec::firmware, "file of the image").required().not_in(Comparison::State),
            field("seed", &RabSpec::seed, "of the run"),
            field("crystal_ppm", &RabSpec::crystal_ppm, "error of the 4 MHz crystal, + is fast").in("ppm"),
            field("adc_noise", &RabSpec::adc_noise, "standard deviation of the converter's noise")
                .in("counts")
                .within(0, 1000),
            field("i2c_hertz", &RabSpec::i2c_hertz,
                  "no master on the bus is faster; one that is gets its answers as if it were not")
                .in("Hz"),
            field("nvm", &RabSpec::nvm, "file that keeps flash; empty: none").not_in(Comparison::Run),
            field("can", &RabSpec::can, "CAN modules that are on a bus: bit 0 is module 1").within(0, 3),
            field("log", &RabSpec::log, "file for the board's log; empty: none").not_in(Comparison::State));
    }
};
static_assert(lists_all_fields<RabSpec>);

}  // namespace puckloop::rab
