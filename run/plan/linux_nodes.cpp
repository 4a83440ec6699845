#include "run/plan/linux_nodes.h"

#include "run/plan/plan_kit.h"
#include "run/plan/program_path.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace puckloop::tools {

namespace {

using nlohmann::json;

// A program that computes for ever is reported by its own board, which knows more, before the conductor loses
// patience with the board.
constexpr double kWatchdogShare = 0.5;

}  // namespace

std::int64_t programs_of(const scenarios::Scenario& scenario) {
    return std::count_if(scenario.robots.begin(), scenario.robots.end(),
                         [](const auto& robot) { return robot.linux_board.has_value(); }) +
           (scenario.coordinator && scenario.coordinator->program ? 1 : 0);
}

json linux_spec(const RunSetup& setup, const std::string& name, const scenarios::LinuxBoard& board,
                const RunRequest& request) {
    const std::filesystem::path folder = setup.scenario.file.parent_path();
    json signals = json::array();
    for (const scenarios::LinuxSignal& signal : board.signals)
        signals.push_back({{"time_s", signal.at}, {"signal", signal.send}});
    // A coordinator from outside goes on, and so does the run.
    const bool outside = setup.scenario.coordinator && !setup.scenario.coordinator->uart.empty();
    json spec{
        {"kind", "linux"},
        {"name", name},
        {"program", find_program(board.command[0], folder).string()},
        {"args", std::vector<std::string>(board.command.begin() + 1, board.command.end())},
        {"host_name", board.hostname},
        {"i2c_hertz", setup.scenario.i2c_clock},
        {"seed", setup.scenario.seed},
        {"start_s", board.start},
        {"restart_at", board.restarts},
        {"signals", std::move(signals)},
        {"cwd", board.folder.empty() ? "" : (std::filesystem::absolute(setup.out) / board.folder).string()},
        {"end_signal", board.end_signal},
        {"grace_s", board.grace},
        {"tty_batch_s", board.late.tty_batch},
        {"i2c_hold_s", board.late.i2c_hold},
        {"oversleep_s", board.late.oversleep},
        {"oversleep_jitter_s", board.late.oversleep_jitter},
        {"programs", programs_of(setup.scenario) + (outside ? 1 : 0)},
        {"watchdog_s", request.stall_seconds * kWatchdogShare},
        {"real_time", request.realtime},
        {"log", log_of(setup, name)}};
    return spec;
}

}  // namespace puckloop::tools
