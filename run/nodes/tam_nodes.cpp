#include "run/nodes/tam_nodes.h"

#include "base/error.h"
#include "emu/tam_avr/signals.h"
#include "run/files/program_path.h"
#include "run/nodes/plan_kit.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

using scenarios::TamBoard;

// The boot loader's 115 200 baud and some more: slower frames are not delayed.
constexpr double kFastestConsole = 120'000.0;

std::filesystem::path firmware_of(const RunSetup& setup, const TamBoard& tam) {
    if (!tam.firmware.empty()) return full_path(tam.firmware);
    if (const auto own = own_image("tam"); !own.empty()) return own;
    throw InputError(setup.scenario.file.string(), tam.name,
                     "the project's own firmware for TAMs is not built, because avr-gcc was missing",
                     "Debian's gcc-avr before puckloop is built, or --firmware tam=IMAGE");
}

tam::TamSpec tam_spec(const RunSetup& setup, const TamBoard& tam) {
    return {.name = tam.name + ".avr",
            .firmware = firmware_of(setup, tam).string(),
            .boot_loader = tam.boot_loader.empty() ? "" : full_path(tam.boot_loader).string(),
            .seed = setup.scenario.seed,
            .resonator_ppm = tam.resonator_ppm,
            .adc_noise = tam.adc_noise,
            .network = tam.network,
            .battery = tam.battery,
            .start = tam.start,
            .resets = tam.resets,
            .log = log_of(setup, tam.name + ".avr")};
}

}  // namespace

void describe_booths(scenarios::Scenario& scenario) {
    for (physics::Booth& booth : scenario.world.booths)
        booth.signals = ids_of(tam::signals());
}

void add_tams(RunSetup& setup, const RunRequest& request) {
    for (const TamBoard& tam : setup.scenario.tams) {
        const std::string board = tam.name + ".avr";
        add_free(setup, board, tam_spec(setup, tam));
        cosim::LinkSpec world{tam.name + ".world", {board, "world"}, {"world", tam.name}};
        world.signal_names = names_of(tam::signals());
        setup.links.push_back(world);
        if (!tam.console.empty())
            add_outside(setup, tam.name + ".console", tam.console, tam.console_baud, {board, "console"},
                        kFastestConsole, request);
    }
}

void name_linked_ports(RunSetup& setup) {
    for (PlannedNode& node : setup.nodes) {
        auto* tam = std::get_if<tam::TamSpec>(&node.what.kind);
        if (tam == nullptr) continue;
        const auto linked = [&](std::string_view port) {
            return std::any_of(setup.links.begin(), setup.links.end(), [&](const cosim::LinkSpec& link) {
                const auto is = [&](const cosim::PortRef& end) {
                    return end.node == node.name && end.port == port;
                };
                return is(link.a) || is(link.b);
            });
        };
        tam->pins_linked = linked("pins");
        tam->ir_linked = linked("ir");
    }
}

}  // namespace puckloop::tools
