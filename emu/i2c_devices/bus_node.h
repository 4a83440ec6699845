#pragma once
// A robot's I2C bus with its usual devices, from a description.

#include "cosim/node.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::i2c_devices {

struct BusSpec {
    std::string name = "i2c";
    bool ground_sensor = true;  ///< 0x60
    bool rgb_turret = true;     ///< 0x61
    /// The bus's nominal clock, Hz: the fastest master's. It is also the bus's lookahead.
    double hertz = 100e3;
    /// Devices that are nodes of their own: port name and 7-bit address.
    std::vector<std::pair<std::string, std::uint8_t>> boards{};
    std::string log{};  ///< file for the bus's log; empty: none
};

/// Ports: "pic" and "linux" (masters), the boards in their order, "world" (signals()).
std::unique_ptr<cosim::Node> make_bus_node(const BusSpec& spec);

/// The same from JSON: {"name", "ground_sensor", "rgb_turret", "hertz", "boards": [{"name", "address"}],
/// "log"}, all optional. Throws InputError.
std::unique_ptr<cosim::Node> make_bus_node(std::string_view json);

}  // namespace puckloop::i2c_devices
