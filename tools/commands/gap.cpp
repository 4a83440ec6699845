// `puckloop gap` is a program of its own, puckloop-gap beside this one: it takes as long to build as all the
// rest, and a run needs none of it.

#include "tools/cli/command.h"
#include "tools/commands.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace puckloop::tools {

int become_gap(char** words) {
    std::error_code failed;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", failed);
    const auto program = self.parent_path() / "puckloop-gap";
    ::execv(program.c_str(), words);
    std::fprintf(stderr, "puckloop: gap: %s: %s (expected the program that ./puckloop gap builds)\n",
                 program.c_str(), std::strerror(errno));
    return 2;
}

void declare_gap(Command& app, int&) {
    app.add_subcommand("gap", "simulation against measured data: what is wrong, why, and what is gained");
}

}  // namespace puckloop::tools
