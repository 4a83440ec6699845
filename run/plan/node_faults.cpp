#include "run/plan/node_faults.h"

#include "base/error.h"
#include "cosim/faults/kinds/kind_facts.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

void assign_faults(RunSetup& setup) {
    auto& faults = setup.scenario.faults;
    cosim::name_faults(faults);
    for (PlannedNode& node : setup.nodes)
        node.what.faults.clear();
    const auto assign_to = [&](const std::string& name, std::size_t f) {
        if (name.empty()) return;
        const auto node = std::find_if(setup.nodes.begin(), setup.nodes.end(),
                                       [&](const PlannedNode& one) { return one.name == name; });
        if (node == setup.nodes.end())
            throw InputError("", "fault", fmt::format("there is no node {}", name));
        node->what.faults.push_back({faults[f], setup.scenario.seed, f});
    };
    for (std::size_t f = 0; f < faults.size(); ++f)
        assign_to(shared_with(setup, faults[f]), f);  // first: of two profiles a board's own holds
    for (std::size_t f = 0; f < faults.size(); ++f)
        assign_to(faults[f].node, f);
}

std::string shared_with(const RunSetup& setup, const cosim::FaultSpec& fault) {
    if (!cosim::is_of_battery(fault)) return "";
    for (const scenarios::RobotBoards& robot : setup.scenario.robots)
        if (robot.rab && fault.node == robot.name + ".pic") return robot.name + ".rab";
    return "";
}

}  // namespace puckloop::tools
