#include "run/nodes/radio_nodes.h"

#include "emu/tam_avr/signals.h"
#include "run/files/program_path.h"
#include "run/nodes/linux_nodes.h"
#include "run/nodes/plan_kit.h"

#include <fmt/format.h>

#include <map>

namespace puckloop::tools {

namespace {

using scenarios::TamBoard;
using scenarios::XBeeModule;

constexpr double kRadioBaud = 9600.0;  // BD = 3, nominal rate of the lines to modules

/// Frames on a line come no faster: the module's own divider makes 9615 baud, and oscillators are a little
/// off.
constexpr double nominal(double baud) {
    return baud * 1.02;
}

xbee::ModuleSpec module_spec(const RunSetup& setup, const std::string& name, const XBeeModule& module,
                             double start) {
    std::map<std::string, std::uint32_t> parameters{{"AP", 2}, {"BD", 3}};
    for (const auto& [command, value] : module.parameters)
        parameters[command] = value;
    xbee::ModuleOptions options;
    options.name = name;
    options.seed = setup.scenario.seed;
    options.address = module.address;
    options.node_identifier = module.node_id;
    options.parameters.assign(parameters.begin(), parameters.end());
    options.start = cosim::from_seconds(start);
    options.boot = cosim::from_seconds(std::max(module.boot, setup.scenario.radio.processing));
    options.processing = cosim::from_seconds(setup.scenario.radio.processing);
    return {std::move(options)};
}

void add_air(RunSetup& setup, radio::EtherSpec& ether, const std::string& owner, double x, double y) {
    ether.stations.push_back({owner, {x, y, 0.0}});
    cosim::LinkSpec link{owner + ".radio", {owner + ".xbee", "radio"}, {"ether", owner}};
    link.latency = kTransfer;
    setup.links.push_back(link);
}

void add_tam_module(RunSetup& setup, radio::EtherSpec& ether, const TamBoard& tam,
                    const physics::Booth& booth) {
    const std::string node = tam.name + ".xbee", board = tam.name + ".avr";
    xbee::ModuleSpec spec = module_spec(setup, node, tam.xbee, tam.start);
    spec.pins = ids_of(tam::signals());
    add_free(setup, node, std::move(spec));
    setup.links.push_back({node, {board, "xbee"}, {node, "uart"}, nominal(kRadioBaud)});
    cosim::LinkSpec pins{tam.name + ".pins", {board, "pins"}, {node, "pins"}};
    pins.signal_names = names_of(tam::signals());
    setup.links.push_back(pins);
    add_air(setup, ether, tam.name, booth.x, booth.y);
}

void add_coordinator(RunSetup& setup, radio::EtherSpec& ether, const RunRequest& request) {
    const scenarios::CoordinatorPlace& place = *setup.scenario.coordinator;
    const std::string node = "coordinator.xbee";
    add_free(setup, node, module_spec(setup, node, place.module, 0.0));
    if (!place.uart.empty())
        add_outside(setup, "coordinator.uart", place.uart, place.baud, {node, "uart"}, nominal(place.baud),
                    request);
    if (place.program) {
        const std::string computer = "coordinator.linux";
        LinuxProgram spec = linux_program(setup, computer, *place.program, request);
        spec.program.tty = place.tty;
        spec.program.i2c.clear();
        // It works in a folder of the results; files of its own lie beside the scenario.
        spec.program.env = {
            {"PUCKLOOP_SCENARIO_FOLDER", full_path(setup.scenario.file).parent_path().string()}};
        setup.nodes.push_back({computer, {std::move(spec)}});
        setup.links.push_back({"coordinator.uart", {computer, "uart"}, {node, "uart"}, nominal(kRadioBaud)});
    }
    add_air(setup, ether, "coordinator", place.x, place.y);
}

}  // namespace

void add_radio(RunSetup& setup, const RunRequest& request) {
    const scenarios::Scenario& scenario = setup.scenario;
    radio::EtherSpec ether;
    if (scenario.coordinator) add_coordinator(setup, ether, request);
    for (std::size_t i = 0; i < scenario.tams.size(); ++i)
        if (scenario.tams[i].xbee.fitted)
            add_tam_module(setup, ether, scenario.tams[i], scenario.world.booths[i]);
    if (ether.stations.empty()) return;
    const scenarios::RadioMedium& air = scenario.radio;
    ether.seed = scenario.seed;
    ether.propagation = {air.range, air.exponent, air.loss};
    ether.processing = cosim::from_seconds(air.processing);
    add_free(setup, ether.name, ether);
}

}  // namespace puckloop::tools
