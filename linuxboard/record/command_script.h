#pragma once
// A script of wheel commands: lines "seconds left right" (steps/s); each holds until the next one. Empty
// lines and what follows a # are ignored.

#include <filesystem>
#include <vector>

namespace puckloop::control {

struct ScriptedCommand {
    double seconds, left, right;
};

/// In order of time, at least one. Throws std::runtime_error with one line naming file and line.
std::vector<ScriptedCommand> read_command_script(const std::filesystem::path& file);

}  // namespace puckloop::control
