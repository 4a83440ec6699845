// `puckloop check FILE`: everything but running.

#include "base/error.h"
#include "base/json.h"
#include "base/text/toml_file.h"
#include "campaigns/engine/campaign_file.h"
#include "run/factory/preflight.h"
#include "run/setup.h"
#include "scenarios/argos/import.h"
#include "tools/cli/command.h"
#include "tools/files/scenario_name.h"
#include "tools/guide/cost_estimate.h"
#include "tools/guide/guide.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct CheckOptions {
    fs::path file;
    bool json = false;
};

bool has_table(const TomlValue& root, const std::string& name) {
    const auto& table = std::get<TomlTable>(root.data);
    return std::any_of(table.begin(), table.end(), [&](const auto& entry) { return entry.first == name; });
}

std::string count(std::size_t number, const char* what) {
    return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

ordered_json check_scenario(const RunRequest& request) {
    const RunSetup setup = set_up(request);
    check_files(setup);
    const scenarios::Scenario& scenario = setup.scenario;
    const CostEstimate cost = estimate_cost(scenario);
    const auto seconds = [&](double factor) {
        return cost.simulated_s ? ordered_json(*cost.simulated_s * factor) : ordered_json(nullptr);
    };
    return {{"format", 1},
            {"file", request.scenario.string()},
            {"kind", "scenario"},
            {"robots", scenario.robots.size()},
            {"tams", scenario.tams.size()},
            {"nodes", setup.nodes.size()},
            {"faults", scenario.faults.size()},
            {"events", scenario.events.events.size()},
            {"duration_s", cost.simulated_s ? ordered_json(*cost.simulated_s) : ordered_json(nullptr)},
            {"estimate",
             {{"in_process_wall_per_simulated_second_s", cost.one_process_s},
              {"in_process_wall_s", seconds(cost.one_process_s)},
              {"processes_wall_per_simulated_second_s", cost.many_processes_s},
              {"processes_wall_s", seconds(cost.many_processes_s)}}},
            {"warnings", setup.warnings}};
}

ordered_json check_campaign(const fs::path& file) {
    const faults::Campaign campaign = faults::read_campaign(file);
    RunRequest request;
    request.scenario = campaign.scenario;
    request.firmware = campaign.firmware;
    request.linux_command = campaign.program;
    request.duration = campaign.duration;
    ordered_json result = check_scenario(request);
    result["file"] = file.string();
    result["kind"] = "campaign";
    result["scenario"] = campaign.scenario.string();
    result["sweeps"] = campaign.sweeps.size();
    result["cases_at_most"] = campaign.cases;
    return result;
}

void print(const ordered_json& result) {
    const bool campaign = result.at("kind") == "campaign";
    fmt::print("{}: {}, no mistake found\n", result.at("file").get<std::string>(),
               result.at("kind").get<std::string>());
    if (campaign)
        fmt::print("  {} over {}, at most {}\n", count(result.at("sweeps"), "sweep"),
                   result.at("scenario").get<std::string>(), count(result.at("cases_at_most"), "case"));
    fmt::print("  {}, {}, {}, {}, {}\n", count(result.at("robots"), "robot"), count(result.at("tams"), "TAM"),
               count(result.at("nodes"), "node"), count(result.at("faults"), "fault"),
               count(result.at("events"), "event"));
    const ordered_json& cost = result.at("estimate");
    const auto line = [&](const char* what, const char* key) {
        const double second = cost.at(fmt::format("{}_wall_per_simulated_second_s", key));
        const ordered_json& whole = cost.at(fmt::format("{}_wall_s", key));
        fmt::print("  {}: about {:.3g} times real time", what, 1.0 / second);
        if (!whole.is_null())
            fmt::print(", {:g} s take {:.2g} s", result.at("duration_s").get<double>(), whole.get<double>());
        fmt::print("\n");
    };
    line("with --in-process", "in_process");
    line("with a process per node", "processes");
    fmt::print("  (on two cores as in docs/performance.md; other firmware costs more or less)\n");
    for (const auto& warning : result.at("warnings"))
        fmt::print("  warning: {}\n", warning.get<std::string>());
}

int check(const CheckOptions& options) {
    const fs::path file = scenario_named(options.file);
    RunRequest request;
    request.scenario = file;
    const bool campaign = !argos::is_experiment(file) && has_table(read_toml(file), "campaign");
    const ordered_json result = campaign ? check_campaign(file) : check_scenario(request);
    if (options.json)
        fmt::print("{}\n", result.dump(2));
    else
        print(result);
    return 0;
}

}  // namespace

void declare_check(Command& app, int& status) {
    auto options = std::make_shared<CheckOptions>();
    Command* command = app.add_subcommand(
        "check", "everything but running: keys, images, programs, devices, and what a run costs");
    command->add_option("file", options->file, "scenario or campaign, or a shipped scenario's name")
        ->required()
        ->type_name("FILE");
    command->add_flag("--json", options->json, "print one JSON object");
    command->footer("Status 2 and one line for the first mistake, as puckloop run.");
    command->callback([options, &status] { status = check(*options); });
}

}  // namespace puckloop::tools
