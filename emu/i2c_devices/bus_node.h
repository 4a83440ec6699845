#pragma once
// A robot's I2C bus with its usual devices, from a description.

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
    std::string name;                       ///< of the port
    std::optional<std::uint8_t> address{};  ///< 7 bits: it hears this one only; without: its firmware decides
    bool prompt = false;                    ///< it never stretches (cosim/i2c/i2c_bus.h)
};

struct BusSpec {
    std::string name = "i2c";
    bool ground_sensor = true;  ///< 0x60
    bool rgb_turret = true;     ///< 0x61
    bool lsm330 = false;        ///< 0x1E and 0x6A: accelerometer and gyroscope of the main board
    std::uint64_t seed = 1;     ///< of its noise
    /// The bus's nominal clock, Hz: the fastest master's. It is also the bus's lookahead.
    double hertz = 100e3;
    std::vector<BoardOnBus> boards{};
    std::string log{};  ///< file for the bus's log; empty: none
    std::vector<cosim::CarriedFault> faults{};
};

/// Ports: "pic" and "linux" (masters), the boards in their order, "world" (signals()).
std::unique_ptr<cosim::Node> make_bus_node(const BusSpec& spec);

/// The same from JSON: {"name", "ground_sensor", "rgb_turret", "lsm330", "seed", "hertz", "boards": [{"name",
/// "address", "prompt"}], "log", "faults"}, all optional but a board's name. Throws InputError.
std::unique_ptr<cosim::Node> make_bus_node(std::string_view json);

}  // namespace puckloop::i2c_devices
