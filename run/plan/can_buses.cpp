#include "run/plan/can_buses.h"

#include "run/plan/plan_kit.h"

#include <nlohmann/json.hpp>

namespace puckloop::tools {

using nlohmann::json;
using scenarios::CanBus;
using scenarios::CanController;

void add_can_modules(const scenarios::Scenario& scenario, const std::string& board, json& spec) {
    unsigned modules = 0;
    for (const CanBus& bus : scenario.can_buses)
        for (const CanController& controller : bus.controllers)
            if (controller.board == board) modules |= 1u << (controller.unit - 1);
    if (modules != 0) spec["can"] = modules;
}

void add_can_buses(RunSetup& setup) {
    for (const CanBus& bus : setup.scenario.can_buses) {
        json names = json::array();
        for (const CanController& controller : bus.controllers) {
            names.push_back(controller.name());
            setup.links.push_back({bus.name + "." + controller.name(),
                                   {controller.board, controller.port()},
                                   {bus.name, controller.name()}});
        }
        add_free(setup, bus.name,
                 {{"kind", "can_bus"},
                  {"name", bus.name},
                  {"controllers", std::move(names)},
                  {"log", log_of(setup, bus.name)}});
    }
}

}  // namespace puckloop::tools
