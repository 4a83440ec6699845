#pragma once
// The ports of a dsPIC board's CAN modules that a run puts on a bus: "can1", "can2".

#include "cosim/core/message.h"
#include "cosim/core/node.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::board {

/// CAN modules by bit: bit 0 is CAN1.
using CanModules = std::uint8_t;
inline constexpr int kCanModules = 2;

class CanPorts {
  public:
    /// Adds a port for each of `modules`.
    void add(CanModules modules, std::vector<cosim::Port>& ports) {
        for (int unit = 1; unit <= kCanModules; ++unit) {
            if (!(modules >> (unit - 1) & 1)) continue;
            ports_.at(static_cast<std::size_t>(unit - 1)) = static_cast<cosim::PortIndex>(ports.size());
            ports.push_back({"can" + std::to_string(unit), cosim::PortKind::Can});
        }
    }
    cosim::PortIndex port_of(int unit) const { return *ports_.at(static_cast<std::size_t>(unit - 1)); }
    int unit_of(cosim::PortIndex port) const { return ports_[0] == port ? 1 : 2; }

  private:
    std::array<std::optional<cosim::PortIndex>, kCanModules> ports_{};
};

}  // namespace puckloop::board
