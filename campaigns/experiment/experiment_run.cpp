#include "campaigns/experiment/experiment_run.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "campaigns/jobs/full_disk.h"
#include "campaigns/jobs/input_files.h"
#include "campaigns/jobs/isolated.h"
#include "cosim/resume/state_file.h"
#include "run/factory/preflight.h"
#include "run/plan/overrides.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "scenarios/reader/read_scenario.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

namespace puckloop::swarm {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr double kStall = 60.0;  ///< s of wall time: a busy machine must not end a run

tools::RunRequest request_of(const Experiment& experiment, const Run& run) {
    const Variant& program = experiment.programs.at(run.program);
    const Variant& condition = experiment.conditions.at(run.condition);
    tools::RunRequest request;
    request.scenario = experiment.scenario;
    request.mission = experiment.mission;
    request.floor = experiment.floor;
    request.duration = experiment.duration;
    request.linux_start = experiment.program_start;
    request.seed = run.seed;
    // What a condition changes counts over what a program does.
    for (const Variant* variant : {&program, &condition}) {
        for (const std::string& assignment : variant->variables) {
            const std::string name = assignment.substr(0, assignment.find('=') + 1);
            std::erase_if(request.variables, [&](const std::string& one) { return one.starts_with(name); });
            request.variables.push_back(assignment);
        }
        request.firmware.insert(request.firmware.end(), variant->firmware.begin(), variant->firmware.end());
        if (!variant->program.empty()) request.linux_command = variant->program;
        if (!variant->model.empty()) request.overlay = variant->model;
    }
    request.in_process = true;
    request.threads = 1;
    request.stall_seconds = kStall;
    request.cache = true;
    return request;
}

json read_report(const fs::path& folder) {
    std::ifstream in(folder / "report.json");
    json report = json::parse(in, nullptr, false);
    if (!report.is_object())
        throw RunError(fmt::format("{}: is missing or damaged", (folder / "report.json").string()));
    return report;
}

}  // namespace

json to_json(const RunResult& result) {
    json text{{"score", nullptr},        {"more_is_better", result.more_is_better},
              {"failed", result.failed}, {"simulated_s", result.simulated},
              {"wall_s", result.wall},   {"trace_sha256", result.trace}};
    if (result.score) text["score"] = *result.score;
    return text;
}

RunResult result_from_json(const json& text) {
    RunResult result;
    if (text.at("score").is_number()) result.score = text.at("score").get<double>();
    result.more_is_better = text.at("more_is_better");
    result.failed = text.at("failed");
    result.simulated = text.at("simulated_s");
    result.wall = text.at("wall_s");
    result.trace = text.at("trace_sha256");
    return result;
}

void check_run(const Experiment& experiment, const Run& run, const fs::path& folder) {
    const Variant& program = experiment.programs.at(run.program);
    const Variant& condition = experiment.conditions.at(run.condition);
    const std::string line =
        fmt::format("line {}", experiment.conditions.size() > 1 ? condition.line : program.line);
    tools::RunRequest request = request_of(experiment, run);
    request.out = folder;
    request.cache = false;
    bool scored = false;
    try {
        const tools::RunSetup setup = tools::set_up(request);
        tools::check_files(setup);
        scored = setup.scenario.mission || experiment.score != Experiment{}.score;
    } catch (const InputError& error) {
        throw InputError(experiment.file.string(), line,
                         fmt::format("'{}' under '{}': {}", program.name, condition.name, error.what()));
    }
    if (!scored)
        throw InputError(experiment.file.string(), line, "its scenario has no [mission] that scores a run",
                         "mission = \"FILE\" with a [mission], or score = \"/...\" in report.json");
}

std::string identity_of(const Experiment& experiment) {
    jobs::InputFiles inputs;
    inputs.add(experiment.file);
    inputs.add(experiment.floor);
    for (std::size_t program = 0; program < experiment.programs.size(); ++program)
        for (std::size_t condition = 0; condition < experiment.conditions.size(); ++condition) {
            const tools::RunRequest request =
                request_of(experiment, {0, program, condition, experiment.seeds.front()});
            scenarios::Scenario scenario =
                scenarios::read_scenario(request.scenario, tools::settings_of(request));
            tools::apply(request, scenario);
            inputs.add_scenario(scenario);
            inputs.add(request.overlay);
        }
    const json identity{{"files", inputs.files()}, {"build", cosim::build_id()}};
    return identity.dump(-1, ' ', true, json::error_handler_t::replace);
}

RunResult execute(const Experiment& experiment, const Run& run, const fs::path& folder,
                  const fs::path& boots) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    make_folder(folder);
    ::setenv("PUCKLOOP_CACHE", boots.c_str(), 1);
    RunResult result;
    const auto run_once = [&] {
        tools::RunRequest request = request_of(experiment, run);
        request.out = folder;
        const cosim::Outcome outcome = tools::run_scenario(tools::set_up(request), request, {}, nullptr);
        // A node that failed is a result of its program; anything else is none.
        if (!outcome.success && (outcome.node.empty() || jobs::names_full_disk(outcome.text)))
            throw RunError(outcome.text);
        jobs::check_room(folder);
    };
    try {
        jobs::run_isolated(run_once);
    } catch (const jobs::Broke& broke) {
        jobs::check_room(folder);
        result.failed = broke.what();
        return result;
    }
    const json report = read_report(folder);
    if (!report.value("success", false)) result.failed = report.value("ended_why", "it failed");
    const json::json_pointer place(experiment.score);
    if (result.failed.empty() && report.contains(place) && report.at(place).is_number())
        result.score = report.at(place).get<double>();
    if (report.contains("mission"))
        result.more_is_better = report.at("mission").value("better", "more") != "less";
    result.simulated = report.value("simulated_s", 0.0);
    result.wall = report.value("wall_s", 0.0);
    result.trace = report.value("trace_sha256", "");
    return result;
}

}  // namespace puckloop::swarm
