// An overlay (`puckloop run --model`): what a verdict found, for any scenario.

#include "physics/description/description.h"
#include "scenarios/reader/read_scenario.h"
#include "scenarios/tables/extension_table.h"
#include "scenarios/tables/linux_keys.h"
#include "scenarios/tables/world_tables.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::scenarios {

namespace {

constexpr double kLongestUartDelay = 10.0;  // s, of [uart]
constexpr double kMostClockError = 2e5;     // ppm, of [clock]

double probability(Reader& reader, const char* key) {
    const double value = reader.quantity(key, Dimension::Ratio, 0.0);
    if (!(value >= 0 && value <= 1))
        reader.fail(key, fmt::format("{} is out of range", key), "0 to 1, or \"5 %\"");
    return value;
}

/// [uart]: what the line between the boards of every robot does to its bytes.
void apply_uart(const std::string& file, const TomlValue& table, Scenario& scenario) {
    Reader reader(file, "uart", table);
    const double late = reader.quantity("command_delay", Dimension::Time, 0.0);
    if (!(late >= 0 && late <= kLongestUartDelay))
        reader.fail("command_delay", "command_delay is out of range", "0 to 10 s");
    const double commands = probability(reader, "command_loss"), answers = probability(reader, "answer_loss"),
                 cut = probability(reader, "answer_cut"), again = probability(reader, "answer_cut_again"),
                 edges = probability(reader, "answer_edge_loss");
    if (again > 0 && cut == 0)
        reader.fail("answer_cut_again", "answer_cut_again does nothing without a cut before",
                    "answer_cut above 0 besides");
    reader.finish();
    for (const RobotBoards& robot : scenario.robots) {
        if (!robot.linux_board) continue;
        const auto add = [&](const char* from, const char* kind, double share) -> cosim::FaultSpec& {
            cosim::FaultSpec& fault = scenario.faults.emplace_back();
            fault.link = robot.name + ".uart";
            fault.from = robot.name + from;
            fault.kind = kind;
            fault.probability = share;
            fault.may_not_fire = true;
            return fault;
        };
        if (late > 0) add(".linux", "delay", 1.0).set("delay", late);
        if (commands > 0) add(".linux", "drop", commands);
        if (answers > 0) add(".pic", "drop", answers);
        if (edges > 0) add(".pic", "drop", edges).bytes = {0x00, 0xFF};
        if (cut > 0) add(".pic", "cut", cut).set("again", again);
    }
}

/// [linux]: what every Linux board is late with.
void apply_linux(const std::string& file, const TomlValue& table, Scenario& scenario) {
    Reader reader(file, "linux", table);
    LinuxDelays late;
    read_delays(reader, late);
    for (RobotBoards& robot : scenario.robots)
        if (robot.linux_board) read_delays(reader, robot.linux_board->late);
    reader.finish();
}

/// [clock]: the main boards' crystals run by so much faster than the scenario states.
void apply_clock(const std::string& file, const TomlValue& table, Scenario& scenario) {
    Reader reader(file, "clock", table);
    const double error = reader.quantity("pic_error", Dimension::Ratio, 0.0) * 1e6;
    if (!(std::abs(error) <= kMostClockError))
        reader.fail("pic_error", "pic_error is out of range", "-20 % to 20 %, such as \"20 ppm\"");
    reader.finish();
    for (RobotBoards& robot : scenario.robots)
        robot.pic.crystal_ppm += error;
}

/// [[robot]] with a name: parameters of one robot.
void apply_robot(const std::string& file, const TomlValue& table, Scenario& scenario) {
    Reader reader(file, "robot", table);
    const std::string name = reader.text("name");
    const auto body = std::find_if(scenario.world.robots.begin(), scenario.world.robots.end(),
                                   [&](const physics::Robot& robot) { return robot.name == name; });
    if (body == scenario.world.robots.end())
        reader.fail("name", fmt::format("the scenario has no robot '{}'", name));
    if (const TomlValue* parameters = reader.table("parameters"))
        for (const auto& [parameter, value] : read_parameters(file, name, *parameters))
            body->parameters[parameter] = value;
    reader.finish();
}

}  // namespace

void apply_overlay(Scenario& scenario, const std::filesystem::path& file) {
    const TomlValue root = read_toml(file);
    const std::string name = file.string();
    Reader top(name, "", root);
    if (const TomlValue* table = top.table("parameters"))
        for (const auto& [parameter, value] : read_parameters(name, "parameters", *table))
            scenario.world.parameters[parameter] = value;
    for (const TomlValue* table : top.tables("extension"))
        scenario.world.extension.push_back(read_extension(name, *table));
    for (const TomlValue* table : top.tables("robot"))
        apply_robot(name, *table, scenario);
    if (const TomlValue* table = top.table("uart")) apply_uart(name, *table, scenario);
    if (const TomlValue* table = top.table("linux")) apply_linux(name, *table, scenario);
    if (const TomlValue* table = top.table("clock")) apply_clock(name, *table, scenario);
    if (const TomlValue* table = top.table("measurement"))
        for (const auto& [parameter, value] : std::get<TomlTable>(table->data))
            scenario.ignored.push_back(parameter);
    top.finish();
    physics::check(scenario.world);
}

}  // namespace puckloop::scenarios
