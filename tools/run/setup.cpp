#include "tools/run/setup.h"

#include "base/error.h"
#include "emu/i2c_devices/signals.h"
#include "emu/pic/signals.h"
#include "tools/run/outside_node.h"
#include "tools/run/program_path.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using scenarios::RobotBoards;
using scenarios::Scenario;

// A program that computes for ever is told by its own board, which knows more, before the conductor loses
// patience with the board.
constexpr double kWatchdogShare = 0.5;

std::vector<std::string> names_of(std::span<const cosim::SignalInfo> signals) {
    std::vector<std::string> names;
    for (const cosim::SignalInfo& signal : signals)
        names.push_back(signal.name);
    return names;
}

std::map<std::string, std::uint16_t> ids_of(std::span<const cosim::SignalInfo> signals) {
    std::map<std::string, std::uint16_t> ids;
    for (std::size_t i = 0; i < signals.size(); ++i)
        ids[signals[i].name] = static_cast<std::uint16_t>(i);
    return ids;
}

/// "robot0.pic=x.hex", or "pic=x.hex" for all robots.
void replace_firmware(Scenario& scenario, const std::string& assignment) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == assignment.size())
        throw InputError("", "--firmware", fmt::format("'{}' is not an assignment", assignment),
                         "BOARD=IMAGE");
    const std::string board = assignment.substr(0, equals);
    const std::filesystem::path image = std::filesystem::absolute(assignment.substr(equals + 1));
    std::string known;
    bool found = false;
    for (RobotBoards& robot : scenario.robots) {
        const std::string name = robot.name + ".pic";
        known += fmt::format("{}, ", name);
        if (board != name && board != "pic") continue;
        robot.pic.firmware = image;
        found = true;
    }
    if (!found)
        throw InputError("", "--firmware", fmt::format("the scenario has no board '{}'", board),
                         "one of " + known + "or pic for all");
}

void apply(const RunRequest& request, Scenario& scenario) {
    for (const std::string& assignment : request.firmware)
        replace_firmware(scenario, assignment);
    if (!request.linux_command.empty()) {
        for (RobotBoards& robot : scenario.robots) {
            if (!robot.linux_board) robot.linux_board.emplace().hostname = robot.name;
            robot.linux_board->command = request.linux_command;
            robot.linux_board->command[0] = find_program(request.linux_command[0], ".").string();
        }
    }
    if (request.duration) scenario.duration = request.duration;
    if (request.seed) scenario.seed = scenario.world.seed = *request.seed;
    if (!request.overlay.empty()) apply_overlay(scenario, request.overlay);
}

/// "robot0.pic.log" in the results folder.
std::string log_of(const RunSetup& setup, const std::string& node) {
    return (setup.out / (node + ".log")).string();
}

json pic_spec(const RunSetup& setup, const RobotBoards& robot) {
    const Scenario& scenario = setup.scenario;
    return {{"kind", "pic"},
            {"name", robot.name + ".pic"},
            {"firmware", std::filesystem::absolute(robot.pic.firmware).lexically_normal().string()},
            {"seed", scenario.seed},
            {"crystal_ppm", robot.pic.crystal_ppm},
            {"adc_noise", robot.pic.adc_noise},
            {"selector", robot.pic.selector},
            {"resets", robot.pic.resets},
            {"log", log_of(setup, robot.name + ".pic")}};
}

json linux_spec(const RunSetup& setup, const RobotBoards& robot, bool ends_run, const RunRequest& request) {
    const scenarios::LinuxBoard& board = *robot.linux_board;
    const std::filesystem::path folder = setup.scenario.file.parent_path();
    json spec{{"kind", "linux"},
              {"name", robot.name + ".linux"},
              {"program", find_program(board.command[0], folder).string()},
              {"args", std::vector<std::string>(board.command.begin() + 1, board.command.end())},
              {"host_name", board.hostname},
              {"i2c_hertz", setup.scenario.i2c_clock},
              {"seed", setup.scenario.seed},
              {"start_s", board.start},
              {"restart_at", board.restarts},
              {"exit_ends_run", ends_run},
              {"watchdog_s", request.stall_seconds * kWatchdogShare},
              {"real_time", request.realtime},
              {"log", log_of(setup, robot.name + ".linux")}};
    return spec;
}

/// What the scenario plugs into the board's UART1, if anything.
void add_uart1(RunSetup& setup, const RobotBoards& robot, const RunRequest& request) {
    if (robot.pic.uart1.empty()) return;
    const std::string name = robot.name + ".uart1";
    const std::filesystem::path folder = std::filesystem::absolute(setup.scenario.file).parent_path();
    const exec::UartSpec end = parse_outside(name, robot.pic.uart1, folder.string());
    if (end.kind != exec::UartSpec::Kind::Script && !request.realtime)
        throw InputError(setup.scenario.file.string(), name,
                         fmt::format("'{}' has a clock of its own", robot.pic.uart1),
                         "--realtime, or script:FILE");
    const json spec{{"kind", "outside"},
                    {"name", name},
                    {"end", robot.pic.uart1},
                    {"folder", folder.string()},
                    {"baud", setup.scenario.uart_baud},
                    {"record", (setup.out / (name + ".received")).string()}};
    setup.nodes.push_back({name, spec.dump()});
    setup.links.push_back({name, {name, "uart"}, {robot.name + ".pic", "uart1"}, setup.scenario.uart_baud});
}

void add_robot(RunSetup& setup, const RobotBoards& robot, bool exit_ends_run, const RunRequest& request) {
    const Scenario& scenario = setup.scenario;
    const std::string pic = robot.name + ".pic";
    const std::string bus = robot.name + ".i2c";
    setup.nodes.push_back({pic, pic_spec(setup, robot).dump()});
    setup.nodes.push_back({bus, json{{"kind", "i2c_bus"},
                                     {"name", bus},
                                     {"hertz", scenario.i2c_clock},
                                     {"ground_sensor", robot.ground_sensor},
                                     {"rgb_turret", robot.rgb_turret},
                                     {"log", log_of(setup, bus)}}
                                    .dump()});
    cosim::LinkSpec world{robot.name + ".world", {pic, "world"}, {"world", robot.name + ".board"}};
    world.signal_names = names_of(pic::signals());
    world.record_from_b = false;  // a thousand sensor values a second: in the hash, not in the file
    setup.links.push_back(world);
    cosim::LinkSpec ground{robot.name + ".ground", {bus, "world"}, {"world", robot.name + ".ground"}};
    ground.signal_names = names_of(i2c_devices::signals());
    ground.record_from_b = false;
    setup.links.push_back(ground);
    setup.links.push_back({robot.name + ".i2c.pic", {pic, "i2c"}, {bus, "pic"}});
    add_uart1(setup, robot, request);
    if (!robot.linux_board) return;
    const std::string program = robot.name + ".linux";
    setup.nodes.push_back({program, linux_spec(setup, robot, exit_ends_run, request).dump()});
    setup.links.push_back({robot.name + ".uart", {program, "uart"}, {pic, "uart2"}, scenario.uart_baud});
    setup.links.push_back({robot.name + ".i2c.linux", {program, "i2c"}, {bus, "linux"}});
}

}  // namespace

RunSetup set_up(const RunRequest& request) {
    RunSetup setup;
    setup.scenario = scenarios::read_scenario(request.scenario);
    Scenario& scenario = setup.scenario;
    apply(request, scenario);
    setup.out = std::filesystem::absolute(request.out.empty() ? std::filesystem::path("out") / scenario.name
                                                              : request.out);

    const auto board_ids = ids_of(pic::signals());
    const auto ground_ids = ids_of(i2c_devices::signals());
    for (physics::Robot& body : scenario.world.robots) {
        body.board_signals = board_ids;
        body.ground_signals = ground_ids;
    }
    scenario.world.recording.directory = setup.out.string();
    scenario.world.recording.log = log_of(setup, "world");
    json world = json::parse(physics::to_json(scenario.world));
    setup.nodes.push_back({"world", json{{"kind", "world"}, {"world", std::move(world)}}.dump()});

    const auto programs =
        std::count_if(scenario.robots.begin(), scenario.robots.end(),
                      [](const RobotBoards& robot) { return robot.linux_board.has_value(); });
    for (const RobotBoards& robot : scenario.robots)
        add_robot(setup, robot, programs == 1, request);
    return setup;
}

}  // namespace puckloop::tools
