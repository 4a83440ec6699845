#pragma once
// An e-puck main board as a run describes it. Its camera is the run's matter: what it sees is.

#include "base/fields/field.h"
#include "emu/board/can_ports.h"
#include "emu/pic/board_revision.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::pic {

struct PicSpec {
    static constexpr std::string_view kKind = "pic";
    static constexpr double kAdcNoise = 2.0;

    std::string name;
    std::string firmware;
    std::uint64_t seed = 1;
    double crystal_ppm = 0.0;
    double adc_noise = kAdcNoise;
    std::optional<double> phototransistor_noise{};
    int selector = 0;
    std::vector<double> resets{};
    std::string revision{name_of(Revision::Rev12)};
    std::vector<std::string> errata{};
    bool bluetooth = false;
    bool ircom = false;
    bool i2c_slave = false;
    board::CanModules can = 0;
    std::string nvm{};
    std::string log{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &PicSpec::name, "of the node").required().not_in(Comparison::State),
            field("firmware", &PicSpec::firmware, "file of the image").required().not_in(Comparison::State),
            field("seed", &PicSpec::seed, "of the run"),
            field("crystal_ppm", &PicSpec::crystal_ppm, "error of the 7.3728 MHz crystal, + is fast")
                .in("ppm"),
            field("adc_noise", &PicSpec::adc_noise, "standard deviation of the converter's noise")
                .in("counts")
                .within(0, 1000),
            field("phototransistor_noise", &PicSpec::phototransistor_noise,
                  "the same at the phototransistors; none: as of all channels")
                .in("counts")
                .within(0, 1000),
            field("selector", &PicSpec::selector, "position of the rotary selector").within(0, 15),
            field("resets", &PicSpec::resets, "when the reset button is pressed, rising").in("s"),
            field("board", &PicSpec::revision, "revision of the board: 1.2 or 1.3"),
            field("errata", &PicSpec::errata, "of the chip, by name (emu/dspic/devices/errata.h)"),
            field("bluetooth", &PicSpec::bluetooth, "a Bluetooth module is at UART1, and sees breaks"),
            field("ircom", &PicSpec::ircom, "there is a medium of IRcom at the port \"ir\""),
            field("i2c_slave", &PicSpec::i2c_slave, "other masters of its I2C bus can address it"),
            field("can", &PicSpec::can, "CAN modules that are on a bus: bit 0 is module 1").within(0, 3),
            field("nvm", &PicSpec::nvm, "file that keeps flash and EEPROM; empty: none")
                .not_in(Comparison::Run),
            field("log", &PicSpec::log, "file for the board's log; empty: none").not_in(Comparison::State));
    }
};
static_assert(lists_all_fields<PicSpec>);

}  // namespace puckloop::pic
