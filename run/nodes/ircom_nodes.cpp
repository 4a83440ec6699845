#include "run/nodes/ircom_nodes.h"

#include "emu/pic/signals.h"
#include "emu/tam_avr/signals.h"
#include "run/nodes/plan_kit.h"

#include <numeric>

namespace puckloop::tools {

namespace {

void link(RunSetup& setup, const std::string& name, const cosim::PortRef& board,
          std::span<const cosim::SignalInfo> signals) {
    cosim::LinkSpec light{name + ".ircom", board, {"ircom", name + ".ircom"}};
    light.signal_names = names_of(signals);
    light.record_from_a = light.record_from_b = setup.scenario.record_ircom;
    setup.links.push_back(light);
}

}  // namespace

void add_ircom(RunSetup& setup) {
    if (!setup.scenario.world.ircom) return;
    physics::IrcomSpec spec{.world = setup.scenario.world};
    physics::IrcomIds& ids = spec.options.ids;
    std::iota(ids.pulse.begin(), ids.pulse.end(), pic::kPulse);
    std::iota(ids.light.begin(), ids.light.end(), pic::kInfraredLight);
    ids.emit = tam::kProximityEmit;
    ids.sense = tam::kProximitySense;
    spec.options.words_csv = (setup.out / "ircom.csv").string();
    spec.options.changes = setup.scenario.events.any();
    setup.nodes.push_back({"ircom", {std::move(spec)}});
    for (const scenarios::RobotBoards& robot : setup.scenario.robots)
        link(setup, robot.name, {robot.name + ".pic", "ir"}, pic::signals());
    for (const scenarios::TamBoard& tam : setup.scenario.tams)
        link(setup, tam.name, {tam.name + ".avr", "ir"}, tam::signals());
    cosim::LinkSpec poses{"ircom.world", {"ircom", "world"}, {"world", "ircom"}};
    poses.record_from_b = false;
    setup.links.push_back(poses);
}

}  // namespace puckloop::tools
