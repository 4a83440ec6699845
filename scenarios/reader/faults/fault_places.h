#pragma once
// What faults can sit on: the links and nodes of a scenario that have kinds of faults.

#include "cosim/faults/kinds/kind_table.h"
#include "scenarios/description/scenario.h"

#include <string>
#include <vector>

namespace puckloop::scenarios {

struct FaultPlace {
    std::string name;  ///< as a fault names it: "robot0.uart"
    cosim::PlaceKind kind = cosim::PlaceKind::Uart;
    std::vector<std::string>
        ends{};             ///< of a link: the nodes whose messages can suffer; of a medium: its devices
    std::string carrier{};  ///< the node that carries its faults out; empty: the conductor
    bool is_node = false;   ///< given as `node`, not as `link`
};

std::vector<FaultPlace> fault_places(const Scenario& scenario);

}  // namespace puckloop::scenarios
