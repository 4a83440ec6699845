#pragma once
// Commands that are programs of their own, which `puckloop` becomes: no run needs what they are made of, so
// the first build leaves them out, and the launcher builds each when it is first asked for.

#include "tools/cli/command.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct OtherProgram {
    std::string_view command;
    const char* program;
    const char* about;                 ///< its line in the list of commands, and the first of its own help
    const char* package = "puckloop";  ///< of Debian
};

// clang-format off
inline constexpr std::array kOtherPrograms{
    OtherProgram{"exec", "puckloop-chips", "run one chip or board alone on the bench"},
    OtherProgram{"debug", "puckloop-chips", "debug firmware: lines, variables, registers, back in time"},
    OtherProgram{"dap", "puckloop-chips", "debug adapter for editors, on standard input and output"},
    OtherProgram{"step", "puckloop-chips", "Run single-instruction vectors from stdin"},
    OtherProgram{"asm", "puckloop-chips", "Assemble dsPIC or AVR source; register names of the chip are known"},
    OtherProgram{"disasm", "puckloop-chips", "Disassemble a dsPIC or AVR image or a few words; `asm` takes the result back"},
    OtherProgram{"upload", "puckloop-chips", "a program into an e-puck's flash by its boot loader, on a cable or by Bluetooth"},
    OtherProgram{"replay", "puckloop-records", "execute one node of a recorded run alone, and compare what it sends"},
    OtherProgram{"trace", "puckloop-records", "read a recorded trace: count, filter, decode, export; by itself it counts"},
    OtherProgram{"frames", "puckloop-records", "Encode, decode and check wire formats"},
    OtherProgram{"view", "puckloop-view",
                 "a recorded run as a page in the browser: arena, timeline, frames, sensors; "
                 "of a campaign or experiment, its report with such a page behind each number"},
    OtherProgram{"faults", "puckloop-campaigns", "campaigns of injected faults: what each does to the mission"},
    OtherProgram{"experiment", "puckloop-campaigns",
                 "run programs under conditions with many seeds, or what is left of them, and compare scores"},
    OtherProgram{"bench", "puckloop-bench", "measure the core and runs against a reference of this machine"},
    OtherProgram{"gap", "puckloop-gap", "simulation against measured data: what is wrong, why, and what is gained", "puckloop-gap"},
};
// clang-format on

/// A command's own line of the help. One that is not in the table does not compile.
consteval const char* about(std::string_view command) {
    return std::ranges::find(kOtherPrograms, command, &OtherProgram::command)->about;
}

/// A literal as an argument of a template.
template <std::size_t kSize>
struct CommandName {
    consteval CommandName(const char (&name)[kSize]) { std::copy_n(name, kSize, text); }  // NOLINT: implicit
    char text[kSize]{};
};

/// In puckloop itself: its line in the list of commands.
template <CommandName kName>
void declare_other(Command& app, int&) {
    app.add_subcommand(kName.text, about(kName.text));
}

/// Replaces this process by the other program with the same words, where they name a command of one. Returns
/// 2, an exit status, where that is not built, and nothing for other commands.
std::optional<int> become_other(int argc, char** argv);

/// Throws InputError, naming `option`, which needs the program of `command`, where that is not built.
void check_built(std::string_view command, const std::string& option);

/// Replaces this process by `puckloop WORDS`, or by the program whose command it is. Throws RunError.
[[noreturn]] void become_puckloop(std::vector<std::string> words);

}  // namespace puckloop::tools
