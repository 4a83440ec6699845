// Commands that are programs of their own, which this process becomes: a run needs none of what they are made
// of, so the first build leaves them out. `gap` takes as long to build as all the rest.

#include "base/shipped_files.h"
#include "tools/cli/command.h"
#include "tools/commands.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {
namespace {

struct OtherProgram {
    std::string_view command;
    const char* program;
    const char* about;
    const char* package;  ///< of Debian
};

constexpr std::array kPrograms{
    OtherProgram{"bench", "puckloop-bench", "measure the core and runs against a reference of this machine",
                 "puckloop"},
    OtherProgram{"gap", "puckloop-gap",
                 "simulation against measured data: what is wrong, why, and what is gained", "puckloop-gap"},
};

int become(const OtherProgram& other, std::vector<std::string> words) {
    std::vector<char*> pointers;
    for (std::string& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const std::filesystem::path program = shipped_program(other.program, "tools");
    if (!program.empty()) ::execv(program.c_str(), pointers.data());
    std::fprintf(
        stderr,
        "puckloop: %s: %s: %s (expected Debian's package %s, or the program that ./puckloop %s builds)\n",
        other.command.data(), program.empty() ? other.program : program.c_str(),
        std::strerror(program.empty() ? ENOENT : errno), other.package, other.command.data());
    return 2;
}

}  // namespace

std::optional<int> become_other(int argc, char** argv) {
    const bool help = argc > 2 && std::string_view(argv[1]) == "help";
    const std::string_view command = argc < 2 ? "" : argv[help ? 2 : 1];
    const auto* const other = std::ranges::find(kPrograms, command, &OtherProgram::command);
    if (other == kPrograms.end()) return std::nullopt;
    std::vector<std::string> words(argv, argv + argc);
    if (help) {  // help COMMAND: the same as COMMAND --help
        words.erase(words.begin() + 1);
        words.emplace_back("--help");
    }
    return become(*other, std::move(words));
}

void declare_other_programs(Command& app, int&) {
    for (const OtherProgram& other : kPrograms)
        app.add_subcommand(std::string(other.command), other.about);
}

}  // namespace puckloop::tools
