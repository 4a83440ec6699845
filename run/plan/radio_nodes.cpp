#include "run/plan/radio_nodes.h"

#include "emu/tam_avr/signals.h"
#include "run/plan/linux_nodes.h"
#include "run/plan/plan_kit.h"
#include "run/plan/program_path.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using scenarios::TamBoard;
using scenarios::XBeeModule;

constexpr double kBaud = 9600.0;  // BD = 3, nominal rate of the lines to modules

/// Between a module's microcontroller and its transceiver. More than nothing, so that neither waits for the
/// other where both are due at the same time.
constexpr cosim::Time kTransfer = cosim::kMicrosecond;

/// Frames on a line come no faster: the module's own divider makes 9615 baud, and oscillators are a little
/// off.
constexpr double nominal(double baud) {
    return baud * 1.02;
}

json module_spec(const RunSetup& setup, const std::string& name, const XBeeModule& module, double start) {
    json parameters{{"AP", 2}, {"BD", 3}};
    for (const auto& [command, value] : module.parameters)
        parameters[command] = value;
    return {{"kind", "xbee"},
            {"name", name},
            {"seed", setup.scenario.seed},
            {"address", fmt::format("{:016X}", module.address)},
            {"node_identifier", module.node_id},
            {"parameters", std::move(parameters)},
            {"start_s", start},
            {"boot_s", std::max(module.boot, setup.scenario.radio.processing)},
            {"processing_s", setup.scenario.radio.processing}};
}

void add_air(RunSetup& setup, json& stations, const std::string& owner, double x, double y) {
    stations.push_back({{"name", owner}, {"at", {x, y, 0.0}}});
    cosim::LinkSpec link{owner + ".radio", {owner + ".xbee", "radio"}, {"ether", owner}};
    link.latency = kTransfer;
    setup.links.push_back(link);
}

void add_tam_module(RunSetup& setup, json& stations, const TamBoard& tam, const physics::Booth& booth) {
    const std::string node = tam.name + ".xbee", board = tam.name + ".avr";
    json spec = module_spec(setup, node, tam.xbee, tam.start);
    spec["pins"] = ids_of(tam::signals());
    add_free(setup, node, spec);
    setup.links.push_back({node, {board, "xbee"}, {node, "uart"}, nominal(kBaud)});
    cosim::LinkSpec pins{tam.name + ".pins", {board, "pins"}, {node, "pins"}};
    pins.signal_names = names_of(tam::signals());
    setup.links.push_back(pins);
    add_air(setup, stations, tam.name, booth.x, booth.y);
}

void add_coordinator(RunSetup& setup, json& stations, const RunRequest& request) {
    const scenarios::CoordinatorPlace& place = *setup.scenario.coordinator;
    const std::string node = "coordinator.xbee";
    add_free(setup, node, module_spec(setup, node, place.module, 0.0));
    if (!place.uart.empty())
        add_outside(setup, "coordinator.uart", place.uart, place.baud, {node, "uart"}, nominal(place.baud),
                    request);
    if (place.program) {
        const std::string computer = "coordinator.linux";
        json spec = linux_spec(setup, computer, *place.program, request);
        spec["tty"] = place.tty;
        spec["i2c"] = json::array();
        // It works in a folder of the results; files of its own lie beside the scenario.
        spec["env"] = {{"PUCKLOOP_SCENARIO_FOLDER", full_path(setup.scenario.file).parent_path().string()}};
        setup.nodes.push_back({computer, spec.dump()});
        setup.links.push_back({"coordinator.uart", {computer, "uart"}, {node, "uart"}, nominal(kBaud)});
    }
    add_air(setup, stations, "coordinator", place.x, place.y);
}

}  // namespace

void add_radio(RunSetup& setup, const RunRequest& request) {
    const scenarios::Scenario& scenario = setup.scenario;
    json stations = json::array();
    if (scenario.coordinator) add_coordinator(setup, stations, request);
    for (std::size_t i = 0; i < scenario.tams.size(); ++i)
        if (scenario.tams[i].xbee.fitted)
            add_tam_module(setup, stations, scenario.tams[i], scenario.world.booths[i]);
    if (stations.empty()) return;
    const scenarios::RadioMedium& air = scenario.radio;
    add_free(setup, "ether",
             {{"kind", "ether"},
              {"name", "ether"},
              {"seed", scenario.seed},
              {"range_m", air.range},
              {"exponent", air.exponent},
              {"loss", air.loss},
              {"processing_s", air.processing},
              {"stations", std::move(stations)}});
}

}  // namespace puckloop::tools
