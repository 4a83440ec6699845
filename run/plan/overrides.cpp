#include "run/plan/overrides.h"

#include "base/error.h"
#include "run/files/program_path.h"
#include "scenarios/reader/faults/event_file.h"
#include "scenarios/reader/faults/fault_tables.h"
#include "scenarios/tables/network_tables.h"
#include "scenarios/values/image_key.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tools {

using scenarios::RobotBoards;
using scenarios::Scenario;

namespace {

struct BoardPlace {
    std::string name;  ///< "robot0.pic", "tam0"
    const char* kind;  ///< all of them
    std::filesystem::path* firmware;
};

/// Every board with firmware.
std::vector<BoardPlace> boards_of(Scenario& scenario) {
    std::vector<BoardPlace> boards;
    for (RobotBoards& robot : scenario.robots) {
        boards.push_back({robot.name + ".pic", "pic", &robot.pic.firmware});
        if (robot.rab) boards.push_back({robot.name + ".rab", "rab", &robot.rab->firmware});
    }
    for (scenarios::TamBoard& tam : scenario.tams)
        boards.push_back({tam.name, "tam", &tam.firmware});
    return boards;
}

/// "robot0.pic=x.hex", "tam0=x.elf", or "pic=x.hex" for all of a kind.
void replace_firmware(Scenario& scenario, const std::string& assignment) {
    const auto equals = assignment.find('=');
    const char* problem = equals == std::string::npos       ? "is not an assignment"
                          : equals == 0                     ? "names no board"
                          : equals + 1 == assignment.size() ? "names no image file"
                                                            : nullptr;
    if (problem != nullptr)
        throw InputError("", "--firmware", fmt::format("'{}' {}", assignment, problem), "BOARD=IMAGE");
    const std::string wanted = assignment.substr(0, equals);
    const std::string image = assignment.substr(equals + 1);
    std::string known;
    bool found = false;
    for (const auto& [board, kind, firmware] : boards_of(scenario)) {
        known += board + ", ";
        if (wanted != board && wanted != kind) continue;
        const std::filesystem::path there = scenarios::firmware_named({}, image, kind);
        *firmware = std::filesystem::absolute(there.empty() ? std::filesystem::path(image) : there);
        found = true;
    }
    if (!found)
        throw InputError("", "--firmware", fmt::format("the scenario has no board '{}'", wanted),
                         "one of " + known + "or pic, rab or tam for all");
}

/// The command line's program, and after it the arguments that the scenario has for one; where its first of
/// these (-c) is among those given, they stand alone.
std::vector<std::string> command_with(const std::vector<std::string>& given,
                                      const std::vector<std::string>& arguments) {
    std::vector<std::string> command = given;
    command[0] = find_program(given[0], ".").string();
    if (!arguments.empty() && std::find(given.begin() + 1, given.end(), arguments[0]) == given.end())
        command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
}

/// A Linux board that waits for a program and gets none is not there.
void leave_out_idle_boards(Scenario& scenario) {
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
        RobotBoards& robot = scenario.robots[i];
        if (!robot.linux_board || !robot.linux_board->command.empty()) continue;
        robot.linux_board.reset();
        scenario.world.robots[i].camera = !robot.pic.camera.empty();
    }
}

}  // namespace

scenarios::Settings settings_of(const RunRequest& request) {
    return {request.variables, request.seed, request.floor, request.floor_scale, request.mission};
}

void apply(const RunRequest& request, Scenario& scenario) {
    for (const std::string& assignment : request.firmware)
        replace_firmware(scenario, assignment);
    if (!request.linux_command.empty()) {
        for (RobotBoards& robot : scenario.robots) {
            if (!robot.linux_board) robot.linux_board.emplace().hostname = robot.name;
            robot.linux_board->command = command_with(request.linux_command, robot.linux_board->arguments);
        }
    }
    leave_out_idle_boards(scenario);
    if (request.linux_start)
        for (RobotBoards& robot : scenario.robots)
            if (robot.linux_board) robot.linux_board->start = *request.linux_start;
    if (request.duration) scenario.duration = request.duration;
    if (request.seed) scenario.seed = scenario.world.seed = *request.seed;
    if (!request.overlay.empty()) apply_overlay(scenario, request.overlay);
    scenarios::name_computers(scenario);
    if (!request.events.empty()) {
        scenarios::apply_event_file(request.events, scenario);
        physics::check_events(scenario.events, scenario.world);
    }
    for (const std::string& words : request.faults)
        scenarios::add_fault(words, scenario);
}

}  // namespace puckloop::tools
