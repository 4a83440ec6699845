#include "run/setup.h"

#include "base/error.h"
#include "base/sha256.h"
#include "cosim/remote/node_hosts.h"
#include "emu/camera/model.h"
#include "emu/i2c_devices/signals.h"
#include "emu/pic/board.h"
#include "emu/pic/signals.h"
#include "emu/pic/slave_address.h"
#include "emu/rab_board/signals.h"
#include "physics/description/channels.h"
#include "run/control/control_place.h"
#include "run/expectations/plan_expectations.h"
#include "run/files/program_path.h"
#include "run/files/writable_file.h"
#include "run/nodes/bluetooth_nodes.h"
#include "run/nodes/cameras.h"
#include "run/nodes/can_buses.h"
#include "run/nodes/ircom_nodes.h"
#include "run/nodes/joined_ports.h"
#include "run/nodes/linux_nodes.h"
#include "run/nodes/network_nodes.h"
#include "run/nodes/plan_kit.h"
#include "run/nodes/radio_nodes.h"
#include "run/nodes/tam_nodes.h"
#include "run/plan/host_plan.h"
#include "run/plan/node_faults.h"
#include "run/plan/overrides.h"
#include "run/plan/state_plan.h"
#include "run/plan/stats_plan.h"
#include "run/snapshots/snapshot_plan.h"
#include "scenarios/reader/read_scenario.h"
#include "scenarios/tables/network_tables.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

using scenarios::RobotBoards;
using scenarios::Scenario;

bool has_lsm330(const RobotBoards& robot) {
    return robot.pic.revision == pic::name_of(pic::Revision::Rev13);
}

/// Where no other master is, nobody can address the main board.
bool is_i2c_slave(const RobotBoards& robot) {
    if (!robot.linux_board) return false;
    if (robot.pic.i2c_slave) return *robot.pic.i2c_slave;
    return pic::sets_slave_address(full_path(robot.pic.firmware).string());
}

std::string path_text(const std::filesystem::path& path) {
    return path.empty() ? "" : full_path(path).string();
}

MainBoard main_board(const RunSetup& setup, const RobotBoards& robot, bool i2c_slave) {
    const Scenario& scenario = setup.scenario;
    pic::PicSpec spec{.name = robot.name + ".pic",
                      .firmware = full_path(robot.pic.firmware).string(),
                      .seed = scenario.seed,
                      .crystal_ppm = robot.pic.crystal_ppm,
                      .adc_noise = robot.pic.adc_noise,
                      .selector = robot.pic.selector,
                      .resets = robot.pic.resets,
                      .revision = robot.pic.revision,
                      .errata = robot.pic.errata,
                      .bluetooth = robot.pic.bluetooth.has_value(),
                      .ircom = scenario.world.ircom,
                      .i2c_slave = i2c_slave,
                      .can = can_modules(scenario, robot.name + ".pic"),
                      .nvm = path_text(robot.pic.nvm),
                      .log = log_of(setup, robot.name + ".pic")};
    if (spec.ircom && !robot.pic.adc_noise_given) spec.phototransistor_noise = pic::kPhototransistorNoise;
    MainBoard board{std::move(spec)};
    if (i2c_slave) board.i2c_hertz = scenario.i2c_clock;
    return board;
}

rab::RabSpec rab_spec(const RunSetup& setup, const RobotBoards& robot) {
    const Scenario& scenario = setup.scenario;
    return {.name = robot.name + ".rab",
            .firmware = full_path(robot.rab->firmware).string(),
            .seed = scenario.seed,
            .crystal_ppm = robot.rab->crystal_ppm,
            .adc_noise = robot.rab->adc_noise,
            .i2c_hertz = scenario.i2c_clock,
            .nvm = path_text(robot.rab->nvm),
            .can = can_modules(scenario, robot.name + ".rab"),
            .log = log_of(setup, robot.name + ".rab")};
}

i2c_devices::BusSpec bus_spec(const RunSetup& setup, const RobotBoards& robot, bool main_board_is_slave) {
    i2c_devices::BusSpec spec;
    spec.name = robot.name + ".i2c";
    spec.ground_sensor = robot.ground_sensor;
    spec.rgb_turret = robot.rgb_turret;
    spec.lsm330 = has_lsm330(robot);
    spec.seed = setup.scenario.seed;
    spec.hertz = setup.scenario.i2c_clock;
    spec.log = log_of(setup, robot.name + ".i2c");
    // The board hears every START: its firmware decides which address is its own.
    if (robot.rab) spec.boards.push_back({"rab"});
    if (main_board_is_slave) spec.boards.push_back({.name = "main_board", .main_board = true});
    if (!robot.pic.camera.empty()) spec.boards.push_back({"camera", camera::kI2cAddress, true});
    return spec;
}

/// What the scenario plugs into the board's UARTs, if anything.
void add_uarts(RunSetup& setup, const RobotBoards& robot, const RunRequest& request) {
    const double baud = setup.scenario.uart_baud;
    const auto add = [&](const std::string& port, const std::string& end) {
        if (end.empty()) return;
        add_outside(setup, robot.name + "." + port, end, baud, {robot.name + ".pic", port}, baud, request);
    };
    add("uart1", robot.pic.uart1);
    add("uart2", robot.pic.uart2);
}

/// The range-and-bearing board: on the bus, and in the air.
void add_rab(RunSetup& setup, const RobotBoards& robot) {
    if (!robot.rab) return;
    const std::string rab = robot.name + ".rab";
    add_free(setup, rab, rab_spec(setup, robot));
    setup.links.push_back({robot.name + ".i2c.rab", {rab, "i2c"}, {robot.name + ".i2c", "rab"}});
    cosim::LinkSpec air{robot.name + ".ir", {rab, "ir"}, {"ir", robot.name + ".ir"}};
    air.signal_names = names_of(rab::signals());
    air.record_from_a = air.record_from_b = setup.scenario.record_ir;
    setup.links.push_back(air);
    cosim::LinkSpec supply{robot.name + ".supply", {rab, "world"}, {"world", rab}};
    supply.signal_names = air.signal_names;
    supply.record_from_b = false;
    setup.links.push_back(supply);
    if (!robot.linux_board)
        setup.warnings.push_back(fmt::format("{}: no Linux board: nobody asks the range-and-bearing board "
                                             "anything, unless the main board's firmware does",
                                             robot.name));
}

void add_linux(RunSetup& setup, std::size_t index, const RunRequest& request) {
    const RobotBoards& robot = setup.scenario.robots[index];
    if (!robot.linux_board) return;
    const std::string program = robot.name + ".linux";
    LinuxProgram spec = linux_program(setup, program, *robot.linux_board, request);
    add_cameras(setup, index, spec);
    join_network(setup, robot.name, spec);
    setup.nodes.push_back({program, {std::move(spec)}});
    setup.links.push_back(
        {robot.name + ".uart", {program, "uart"}, {robot.name + ".pic", "uart2"}, setup.scenario.uart_baud});
    setup.links.push_back({robot.name + ".i2c.linux", {program, "i2c"}, {robot.name + ".i2c", "linux"}});
    if (robot.linux_board->cameras.empty()) return;
    cosim::LinkSpec seen{robot.name + ".camera", {program, "camera"}, {"world", robot.name + ".camera"}};
    seen.record_from_b = false;
    setup.links.push_back(seen);
}

void add_robot(RunSetup& setup, std::size_t index, const RunRequest& request) {
    const RobotBoards& robot = setup.scenario.robots[index];
    const std::string pic = robot.name + ".pic";
    const std::string bus = robot.name + ".i2c";
    const bool i2c_slave = is_i2c_slave(robot);
    if (robot.pic.i2c_slave.value_or(false) && !i2c_slave)
        setup.warnings.push_back(
            fmt::format("{}: i2c_slave without a Linux board: nobody addresses the main board", robot.name));
    MainBoard board = main_board(setup, robot, i2c_slave);
    add_board_camera(setup, index, board);
    add_free(setup, pic, std::move(board));
    add_free(setup, bus, bus_spec(setup, robot, i2c_slave));
    cosim::LinkSpec world{robot.name + ".world", {pic, "world"}, {"world", robot.name + ".board"}};
    world.signal_names = names_of(pic::signals());
    world.record_from_b = false;  // a thousand sensor values a second: in the hash, not in the file
    setup.links.push_back(world);
    cosim::LinkSpec ground{robot.name + ".ground", {bus, "world"}, {"world", robot.name + ".ground"}};
    ground.signal_names = names_of(i2c_devices::signals());
    ground.record_from_b = false;
    setup.links.push_back(ground);
    setup.links.push_back({robot.name + ".i2c.pic", {pic, "i2c"}, {bus, "pic"}});
    if (i2c_slave)
        setup.links.push_back({robot.name + ".i2c.main_board", {pic, "i2c_slave"}, {bus, "main_board"}});
    add_uarts(setup, robot, request);
    add_rab(setup, robot);
    add_linux(setup, index, request);
}

/// The world, and what happens to it.
void add_world(RunSetup& setup, const RunRequest& request) {
    scenarios::name_computers(setup.scenario);  // one from outside among them
    physics::EventPlan& events = setup.scenario.events;
    events.live = request.realtime || request.paced;
    events.repeats = !request.realtime || programs_of(setup.scenario) == 0;
    const auto& program = setup.scenario.mission_program;
    events.mission = program.has_value();
    if (events.any()) events.journal = (setup.out / "events.toml").string();
    if (events.live) setup.control = new_control_path();
    WorldSpec spec{.world = setup.scenario.world,
                   .events = events,
                   .control = setup.control,
                   .bluetooth = scenarios::has_bluetooth(setup.scenario),
                   .wifi = hears_world(setup.scenario),
                   .tracker = setup.scenario.tracker};
    if (program)
        spec.mission = {.command = program->command,
                        .better = program->better,
                        .timeout = program->timeout,
                        .log = (setup.out / "mission.log").string(),
                        .duration = setup.scenario.duration};
    setup.nodes.push_back({"world", {std::move(spec)}});
    setup.nodes.back().any_thread = !events.live;
}

/// The infra-red medium, where any robot has a board that uses it.
void add_ir(RunSetup& setup) {
    const auto& robots = setup.scenario.robots;
    if (std::none_of(robots.begin(), robots.end(), [](const RobotBoards& robot) { return robot.rab; }))
        return;
    physics::IrSpec spec{.world = setup.scenario.world};
    spec.options.frames_csv = (setup.out / "ir.csv").string();
    spec.options.changes = setup.scenario.events.any();
    setup.nodes.push_back({"ir", {std::move(spec)}});
    setup.nodes.back().any_thread = true;
    cosim::LinkSpec poses{"ir.world", {"ir", "world"}, {"world", "ir"}};
    poses.record_from_b = false;
    setup.links.push_back(poses);
}

/// "NODE=PLACE": the node is a board, in the run's process and on its thread, where all debuggers are. It
/// begins at power-up.
void debug_board(RunSetup& setup, const std::string& assignment) {
    const std::size_t equals = std::min(assignment.find('='), assignment.size());
    const std::string name = assignment.substr(0, equals);
    std::string known;
    for (PlannedNode& node : setup.nodes) {
        if (!has_board(node.what)) continue;
        known += (known.empty() ? "" : ", ") + node.name;
        if (node.name != name || equals == assignment.size()) continue;
        node.what.care = {.gdb = assignment.substr(equals + 1),
                          .stats = node.what.care.stats,
                          .watches = node.what.care.watches};
        node.in_process = true;
        node.any_thread = false;
        return;
    }
    throw InputError("", "--gdb", fmt::format("'{}' names no board of the scenario", assignment),
                     "NODE=:PORT or NODE=unix:PATH, NODE one of " + known);
}

}  // namespace

RunSetup set_up(const RunRequest& request) {
    RunSetup setup;
    setup.scenario = scenarios::read_scenario(request.scenario, settings_of(request));
    std::error_code none;
    if (std::filesystem::is_regular_file(request.scenario, none))
        setup.scenario_sha256 = sha256_of_file(request.scenario);
    Scenario& scenario = setup.scenario;
    apply(request, scenario);
    add_outside_host(request, scenario);
    scenarios::check_ending(scenario);
    if (!scenario.ignored.empty())
        setup.warnings.push_back(
            fmt::format("{}: [measurement] is of the measuring chain and not of this run: {}",
                        request.overlay.string(), fmt::join(scenario.ignored, ", ")));
    setup.out = std::filesystem::absolute(request.out.empty() ? std::filesystem::path("out") / scenario.name
                                                              : request.out);

    const auto board_ids = ids_of(pic::signals());
    const auto ground_ids = ids_of(i2c_devices::signals());
    const auto rab_ids = ids_of(rab::signals());
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
        physics::Robot& body = scenario.world.robots[i];
        body.board_signals = board_ids;
        body.ground_signals = ground_ids;
        // The one accelerometer or the other.
        const bool lsm330 = has_lsm330(scenario.robots[i]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (lsm330) {
                body.board_signals.erase(
                    std::string(physics::channel_name(physics::kAccelerationChannel + axis)));
                continue;
            }
            for (const std::size_t first : {physics::kForceChannel, physics::kTurnRateChannel})
                body.ground_signals.erase(std::string(physics::channel_name(first + axis)));
        }
        body.rab = scenario.robots[i].rab.has_value();
        if (body.rab) body.rab_signals = rab_ids;
    }
    describe_booths(scenario);
    scenario.world.recording.directory = setup.out.string();
    scenario.world.recording.log = log_of(setup, "world");
    add_world(setup, request);
    plan_joined_ports(setup, request);
    add_ir(setup);

    for (std::size_t i = 0; i < scenario.robots.size(); ++i)
        add_robot(setup, i, request);
    add_tams(setup, request);
    add_radio(setup, request);
    add_bluetooth(setup, request);
    add_network(setup, request);
    add_can_buses(setup);
    add_ircom(setup);
    add_messages(setup);
    name_linked_ports(setup);
    assign_faults(setup);
    plan_states(setup, request);
    if (!request.gdb.empty() && (!request.from_state.empty() || !request.save_state.empty()))
        throw InputError("", "--gdb", "saved states and a debugger do not go together", "one of them");
    for (const std::string& assignment : request.gdb)
        debug_board(setup, assignment);
    plan_stats(setup, request);
    plan_snapshots(setup, request);
    plan_expectations(setup, request);
    if (request.hosts) plan_hosts(setup, request.hosts->count());
    for (const auto& file : {request.junit, request.tap})
        if (!file.empty()) check_writable(file);
    return setup;
}

}  // namespace puckloop::tools
