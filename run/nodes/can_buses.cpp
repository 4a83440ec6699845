#include "run/nodes/can_buses.h"

#include "run/nodes/plan_kit.h"

namespace puckloop::tools {

using scenarios::CanBus;
using scenarios::CanController;

board::CanModules can_modules(const scenarios::Scenario& scenario, const std::string& board) {
    unsigned modules = 0;
    for (const CanBus& bus : scenario.can_buses)
        for (const CanController& controller : bus.controllers)
            if (controller.board == board) modules |= 1u << (controller.unit - 1);
    return static_cast<board::CanModules>(modules);
}

void add_can_buses(RunSetup& setup) {
    for (const CanBus& bus : setup.scenario.can_buses) {
        cosim::CanBusOptions spec;
        spec.name = bus.name;
        spec.log = log_of(setup, bus.name);
        for (const CanController& controller : bus.controllers) {
            spec.controllers.push_back(controller.name());
            setup.links.push_back({bus.name + "." + controller.name(),
                                   {controller.board, controller.port()},
                                   {bus.name, controller.name()}});
        }
        add_free(setup, bus.name, std::move(spec));
    }
}

}  // namespace puckloop::tools
