#include "tools/cli/other_programs.h"

#include "base/error.h"
#include "base/files/shipped_files.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace puckloop::tools {
namespace {

namespace fs = std::filesystem;

const OtherProgram* other_of(std::string_view command) {
    const auto* const other = std::ranges::find(kOtherPrograms, command, &OtherProgram::command);
    return other == kOtherPrograms.end() ? nullptr : other;
}

std::string where_to_get(const OtherProgram& other) {
    return fmt::format("Debian's package {}, or the program that ./puckloop {} builds", other.package,
                       other.command);
}

/// Returns where that fails, with errno.
void execute(const fs::path& program, std::vector<std::string>& words) {
    std::vector<char*> pointers;
    for (std::string& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    errno = ENOENT;
    if (!program.empty()) ::execv(program.c_str(), pointers.data());
}

}  // namespace

std::optional<int> become_other(int argc, char** argv) {
    const bool help = argc > 2 && std::string_view(argv[1]) == "help";
    const OtherProgram* other = other_of(argc < 2 ? "" : argv[help ? 2 : 1]);
    if (other == nullptr) return std::nullopt;
    std::vector<std::string> words(argv, argv + argc);
    if (help) {  // help COMMAND: the same as COMMAND --help
        words.erase(words.begin() + 1);
        words.emplace_back("--help");
    }
    const fs::path program = shipped_program(other->program, "tools");
    execute(program, words);
    std::fprintf(stderr, "puckloop: %s: %s: %s (expected %s)\n", std::string(other->command).c_str(),
                 program.empty() ? other->program : program.c_str(), std::strerror(errno),
                 where_to_get(*other).c_str());
    return 2;
}

void check_built(std::string_view command, const std::string& option) {
    const OtherProgram& other = *other_of(command);
    if (shipped_program(other.program, "tools").empty())
        throw InputError("", option, fmt::format("{} is not there", other.program), where_to_get(other));
}

void become_puckloop(std::vector<std::string> words) {
    const OtherProgram* other = other_of(words.at(0));
    const fs::path program = other != nullptr ? shipped_program(other->program, "tools") : main_program();
    words.insert(words.begin(), "puckloop");
    std::fflush(nullptr);
    execute(program, words);
    throw RunError(fmt::format("puckloop {}: {}", words.at(1), std::strerror(errno)));
}

}  // namespace puckloop::tools
