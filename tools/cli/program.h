#pragma once
// A command line: its subcommands, and one place where failures become exit statuses.

#include "tools/cli/command.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

/// Under which heading the list of all commands has one.
struct Heading {
    std::string_view command, heading;
};

/// Runs the subcommand that `words` (without the program's name) ask for. Help calls the program `name`.
/// Returns the exit status: 0 success, 1 a run or check failed, 2 wrong use or bad input, with one line on
/// standard error.
int run_program(std::span<const DeclareCommand> commands, std::vector<std::string> words,
                std::span<const Heading> headings = {}, const std::string& name = "puckloop");

}  // namespace puckloop::tools
