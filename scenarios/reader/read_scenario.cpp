#include "scenarios/reader/read_scenario.h"

#include "base/error.h"
#include "cosim/faults/kinds/kind_facts.h"
#include "physics/description/parameters.h"
#include "scenarios/argos/import.h"
#include "scenarios/reader/compose/groups.h"
#include "scenarios/reader/compose/include.h"
#include "scenarios/reader/compose/variables.h"
#include "scenarios/reader/events/event_tables.h"
#include "scenarios/reader/faults/fault_tables.h"
#include "scenarios/tables/allowed_failures.h"
#include "scenarios/tables/bluetooth_tables.h"
#include "scenarios/tables/can_tables.h"
#include "scenarios/tables/expect_tables.h"
#include "scenarios/tables/mission_table.h"
#include "scenarios/tables/network_tables.h"
#include "scenarios/tables/radio_tables.h"
#include "scenarios/tables/robot_tables.h"
#include "scenarios/tables/tam_tables.h"
#include "scenarios/tables/world_tables.h"
#include "scenarios/values/field_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::scenarios {

namespace {

constexpr double kLongestRun = 86'400.0 * 30;  // s; simulated time itself reaches 106 days

TomlValue read_tables(const std::filesystem::path& file, const Settings& settings, Scenario& scenario) {
    TomlValue root;
    if (argos::is_experiment(file)) {
        scenario.files.push_back(file);
        argos::Imported imported = argos::import_experiment(file, {settings.floor, settings.floor_scale});
        for (const argos::Note& note : imported.notes)
            scenario.not_taken.push_back(fmt::format("line {}: {}", note.line, note.text));
        root = std::move(imported.scenario);
    } else {
        if (!settings.floor.empty())
            throw InputError("", "--floor", "is for ARGoS experiments",
                             "a [[floor_patch]] with image in the scenario");
        root = read_with_includes(file, scenario.files);
    }
    resolve_variables(root, file.string(), settings.variables);
    return root;
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& file, const Settings& settings) {
    Scenario scenario;
    const std::string name = file.string();
    TomlValue root = read_tables(file, settings, scenario);
    Reader top(name, "", root);
    scenario.file = file;
    scenario.name = file.stem().string();
    if (const TomlValue* table = top.table("run")) {
        Reader run(name, "run", *table);
        scenario.duration = run.optional_quantity("duration", Dimension::Time);
        if (scenario.duration && (*scenario.duration <= 0 || *scenario.duration > kLongestRun))
            run.fail("duration", "duration is out of range", "more than 0 s, at most 720 h");
        scenario.seed =
            static_cast<std::uint64_t>(run.integer("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
        scenario.world.recording.period = run.quantity("record_every", Dimension::Time, 0.1);
        if (const double steps = scenario.world.recording.period * 1e3;
            steps < 1.0 || steps > 3.6e6 || std::abs(steps - std::round(steps)) > 1e-6)
            run.fail("record_every", "record_every is out of range", "a multiple of 1 ms, at most 1 h");
        scenario.uart_baud = run.quantity("uart_baud", Dimension::Number, scenario.uart_baud);
        if (scenario.uart_baud < 300 || scenario.uart_baud > 4e6)
            run.fail("uart_baud", "uart_baud is out of range", "300 to 4000000");
        scenario.i2c_clock = run.quantity("i2c_clock", Dimension::Frequency, scenario.i2c_clock);
        if (scenario.i2c_clock < 1e3 || scenario.i2c_clock > 1e6)
            run.fail("i2c_clock", "i2c_clock is out of range", "1 kHz to 1 MHz");
        scenario.ideal_linux_clocks = run.flag("ideal_linux_clocks", false);
        scenario.record_ir = run.flag("record_ir", false);
        scenario.allow = read_allowed(run);
        run.finish();
    }
    if (settings.seed) scenario.seed = *settings.seed;
    const double period = scenario.world.recording.period;
    scenario.world = read_world(top);
    scenario.world.recording.period = period;
    scenario.world.seed = scenario.seed;
    for (const TomlValue* table : top.tables("robot"))
        read_robot(name, *table, scenario);
    for (const TomlValue* table : top.tables("tam"))
        read_tam(name, *table, scenario);
    for (const TomlValue* table : top.tables("group"))
        read_group(name, *table, scenario);
    read_mission(top, period, scenario);
    if (!settings.mission.empty()) {
        read_mission_of(settings.mission, period, scenario);
        scenario.files.push_back(settings.mission);
    }
    if (const TomlValue* table = top.table("tracker"))
        read_fields(Reader(name, "tracker", *table), scenario.tracker.emplace());
    else if (scenario.mission_program)
        scenario.tracker.emplace();
    scenario.radio = read_radio(top);
    scenario.coordinator = read_coordinator(top);
    read_bluetooth(top, scenario);
    read_can_buses(top, scenario);
    read_network(top, scenario);
    scenario.world.ircom = !scenario.robots.empty() && !scenario.tams.empty();
    if (const TomlValue* table = top.table("ircom")) {
        Reader ircom(name, "ircom", *table);
        scenario.world.ircom = true;
        scenario.record_ircom = ircom.flag("record", false);
        ircom.finish();
    }
    if (scenario.robots.empty() && scenario.tams.empty() && scenario.hosts.empty())
        top.fail_missing("robot", "at least one [[robot]], [[group]], [[tam]] or [[host]]");
    std::size_t index = 0;
    for (const TomlValue* table : top.tables("fault"))
        scenario.faults.push_back(read_fault(name, index++, *table, scenario));
    scenario.events.events = read_events(top);
    name_computers(scenario);
    scenario.expectations = read_expectations(top);
    top.finish();
    for (std::size_t i = 0; i < scenario.robots.size(); ++i)
        scenario.world.robots[i].rab = scenario.robots[i].rab.has_value();
    physics::check(scenario.world);
    physics::check_events(scenario.events, scenario.world);
    return scenario;
}

void check_ending(const Scenario& scenario) {
    const bool any_program =
        std::any_of(scenario.robots.begin(), scenario.robots.end(),
                    [](const RobotBoards& robot) { return robot.linux_board.has_value(); }) ||
        (scenario.coordinator && scenario.coordinator->program) || scenario.mission_program;
    if (!scenario.duration && !any_program)
        throw InputError(scenario.file.string(), "[run]", "nothing ends this run",
                         "duration = \"60 s\", a robot with a [robot.linux] program, or --duration");
    const bool outlived =
        std::any_of(scenario.faults.begin(), scenario.faults.end(), cosim::outlives_program);
    if (!scenario.duration && outlived)
        throw InputError(scenario.file.string(), "[run]",
                         "nothing ends this run once a fault killed its program",
                         "duration = \"60 s\", --duration, or run = \"ends\" of the fault");
}

}  // namespace puckloop::scenarios
