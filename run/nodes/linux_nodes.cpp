#include "run/nodes/linux_nodes.h"

#include "run/files/program_path.h"
#include "run/nodes/linux_clocks.h"
#include "run/nodes/plan_kit.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

// A program that computes for ever is reported by its own board, which knows more, before the conductor loses
// patience with the board.
constexpr double kWatchdogShare = 0.5;

/// Of a name that the scenario's reader has checked.
int signal_number(const std::string& name) {
    return linuxboard::signal_named(name).value();
}

}  // namespace

std::int64_t programs_of(const scenarios::Scenario& scenario) {
    return std::count_if(scenario.robots.begin(), scenario.robots.end(),
                         [](const auto& robot) { return robot.linux_board.has_value(); }) +
           (scenario.coordinator && scenario.coordinator->program ? 1 : 0);
}

LinuxProgram linux_program(const RunSetup& setup, const std::string& name, const scenarios::LinuxBoard& board,
                           const RunRequest& request) {
    const std::filesystem::path folder = setup.scenario.file.parent_path();
    // A coordinator from outside goes on, and so does the run.
    const bool outside = setup.scenario.coordinator && !setup.scenario.coordinator->uart.empty();
    LinuxProgram described;
    linuxboard::LinuxSpec& spec = described.program;
    spec.name = name;
    spec.program = find_program(board.command[0], folder).string();
    spec.args.assign(board.command.begin() + 1, board.command.end());
    spec.host_name = board.hostname;
    spec.tty = board.serial_devices.front();
    spec.tty_aliases.assign(board.serial_devices.begin() + 1, board.serial_devices.end());
    spec.i2c = board.i2c_devices;
    spec.i2c_hertz = setup.scenario.i2c_clock;
    spec.seed = setup.scenario.seed;
    spec.start = cosim::from_seconds(board.start);
    for (const double time : board.restarts)
        spec.restarts.push_back({cosim::from_seconds(time)});
    for (const scenarios::LinuxSignal& signal : board.signals)
        spec.signals.push_back({cosim::from_seconds(signal.at), signal_number(signal.send)});
    if (!board.folder.empty()) spec.cwd = (std::filesystem::absolute(setup.out) / board.folder).string();
    spec.end_signal = signal_number(board.end_signal);
    spec.grace = cosim::from_seconds(board.grace);
    spec.tty_batch = cosim::from_seconds(board.late.tty_batch);
    spec.i2c_hold = cosim::from_seconds(board.late.i2c_hold);
    const BoardClock clock = clock_of(setup.scenario, name, board);
    spec.system_clock_ppm = clock.error_ppm;
    spec.oversleep = {cosim::from_seconds(clock.oversleep), cosim::from_seconds(clock.jitter)};
    spec.programs = static_cast<std::uint32_t>(programs_of(setup.scenario) + (outside ? 1 : 0));
    spec.watchdog_s = request.stall_seconds * kWatchdogShare;
    spec.real_time = request.realtime;
    spec.log = log_of(setup, name);
    return described;
}

}  // namespace puckloop::tools
