#pragma once
// A robot's I2C bus with its usual devices, from a description.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "cosim/faults/fault_json.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::i2c_devices {

/// A device that is a node of its own.
struct BoardOnBus {
    std::string name;
    std::optional<std::uint8_t> address{};
    bool prompt = false;
    bool main_board = false;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &BoardOnBus::name, "of the port").required(),
            field("address", &BoardOnBus::address,
                  "7 bits: it hears this one only; none: its firmware decides")
                .within(0, 0x77),
            field("prompt", &BoardOnBus::prompt, "it never stretches (cosim/i2c/i2c_bus.h)"),
            field("main_board", &BoardOnBus::main_board, "the slave of the chip that is the master \"pic\""));
    }
};
static_assert(lists_all_fields<BoardOnBus>);

struct BusSpec {
    static constexpr std::string_view kKind = "i2c_bus";

    std::string name = "i2c";
    bool ground_sensor = true;
    bool rgb_turret = true;
    bool lsm330 = false;
    std::uint64_t seed = 1;
    double hertz = 100e3;
    std::vector<BoardOnBus> boards{};
    std::string log{};
    std::vector<cosim::CarriedFault> faults{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &BusSpec::name, "of the node"),
            field("ground_sensor", &BusSpec::ground_sensor, "the floor sensor at 0x60 is there"),
            field("rgb_turret", &BusSpec::rgb_turret, "the RGB turret at 0x61 is there"),
            field("lsm330", &BusSpec::lsm330,
                  "accelerometer and gyroscope of the main board at 0x1E and 0x6A are there"),
            field("seed", &BusSpec::seed, "of the accelerometer's and gyroscope's noise"),
            field("hertz", &BusSpec::hertz, "the fastest master's clock, which is also the bus's lookahead")
                .in("Hz")
                .within(1e3, 3.4e6),
            field("boards", &BusSpec::boards, "devices that are nodes of their own"),
            field("log", &BusSpec::log, "file for the bus's log; empty: none"), unlisted(&BusSpec::faults));
    }
};
static_assert(lists_all_fields<BusSpec>);

/// Ports: "pic" and "linux" (masters), the boards in their order, "world" (signals()). Throws InputError for
/// numbers out of range.
std::unique_ptr<cosim::Node> make_bus_node(const BusSpec& spec);

}  // namespace puckloop::i2c_devices
