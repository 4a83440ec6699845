// `puckloop gap` is a program of its own, puckloop-gap: it takes as long to build as all the
// rest, and a run needs none of it.

#include "base/shipped_files.h"
#include "tools/cli/command.h"
#include "tools/commands.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace puckloop::tools {

int become_gap(char** words) {
    constexpr const char* kName = "puckloop-gap";
    const std::filesystem::path program = shipped_program(kName, "tools");
    if (!program.empty()) ::execv(program.c_str(), words);
    std::fprintf(stderr,
                 "puckloop: gap: %s: %s (expected Debian's package puckloop-gap, or the program that "
                 "./puckloop gap builds)\n",
                 program.empty() ? kName : program.c_str(), std::strerror(program.empty() ? ENOENT : errno));
    return 2;
}

void declare_gap(Command& app, int&) {
    app.add_subcommand("gap", "simulation against measured data: what is wrong, why, and what is gained");
}

}  // namespace puckloop::tools
