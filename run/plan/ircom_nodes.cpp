#include "run/plan/ircom_nodes.h"

#include "emu/pic/signals.h"
#include "emu/tam_avr/signals.h"
#include "run/plan/plan_kit.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace puckloop::tools {

namespace {

using nlohmann::json;

std::vector<int> ids_from(int first, int count) {
    std::vector<int> ids;
    for (int i = 0; i < count; ++i)
        ids.push_back(first + i);
    return ids;
}

void link(RunSetup& setup, const std::string& name, const cosim::PortRef& board,
          std::span<const cosim::SignalInfo> signals) {
    cosim::LinkSpec light{name + ".ircom", board, {"ircom", name + ".ircom"}};
    light.signal_names = names_of(signals);
    light.record_from_a = light.record_from_b = setup.scenario.record_ircom;
    setup.links.push_back(light);
}

}  // namespace

void add_ircom(RunSetup& setup, const json& world) {
    if (!setup.scenario.world.ircom) return;
    const json spec{{"kind", "ircom"},
                    {"name", "ircom"},
                    {"world", world},
                    {"pulse", ids_from(pic::kPulse, pic::kPulseCount)},
                    {"light", ids_from(pic::kInfraredLight, pic::kProximityCount)},
                    {"emit", tam::kProximityEmit},
                    {"sense", tam::kProximitySense},
                    {"csv", (setup.out / "ircom.csv").string()},
                    {"changes", setup.scenario.events.any()}};
    setup.nodes.push_back({"ircom", spec.dump()});
    for (const scenarios::RobotBoards& robot : setup.scenario.robots)
        link(setup, robot.name, {robot.name + ".pic", "ir"}, pic::signals());
    for (const scenarios::TamBoard& tam : setup.scenario.tams)
        link(setup, tam.name, {tam.name + ".avr", "ir"}, tam::signals());
    cosim::LinkSpec poses{"ircom.world", {"ircom", "world"}, {"world", "ircom"}};
    poses.record_from_b = false;
    setup.links.push_back(poses);
}

}  // namespace puckloop::tools
