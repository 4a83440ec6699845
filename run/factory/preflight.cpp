#include "run/factory/preflight.h"

#include "base/error.h"
#include "linuxboard/shim/node/program_file.h"
#include "run/factory/node_factory.h"

#include <fmt/format.h>

#include <unistd.h>

#include <filesystem>
#include <set>
#include <string>

namespace puckloop::tools {

namespace {

/// Names the board whose program it is: a swarm has many, and a scenario may give each another.
void check_program(const std::string& node, const std::string& program) {
    try {
        linuxboard::find_program(program);
    } catch (const InputError& error) {
        throw InputError("", node, error.what());
    }
}

}  // namespace

void check_files(const RunSetup& setup) {
    if (const auto& mission = setup.scenario.mission_program) {
        const std::string& program = mission->command.front();
        if (::access(program.c_str(), X_OK) != 0 || std::filesystem::is_directory(program))
            throw InputError(mission->file, mission->place,
                             fmt::format("the mission program {} cannot be executed", program),
                             "a file that may be executed (chmod +x), with its interpreter in line 1");
    }
    std::set<std::string> known;  // robots of a swarm differ in little else than their names
    for (const PlannedNode& node : setup.nodes) {
        if (const auto* linux = std::get_if<LinuxProgram>(&node.what.kind))
            check_program(node.name, linux->program.program);
        if (!has_board(node.what)) continue;
        NodeDescription spec = node.what;
        board_fields(spec).log.clear();  // this one leaves nothing on disk
        NodeDescription what = spec;
        board_fields(what).name.clear();
        board_fields(what).seed = 0;
        what.care = {.watches = what.care.watches};
        if (known.insert(encode(what)).second) make_board(spec);
    }
}

}  // namespace puckloop::tools
