#pragma once
// `puckloop gap` and its subcommands, each in a file of its own.

#include "gap/kinds/kind.h"
#include "selftest/emulate/stage.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

class Command;

/// A built-in kind, one from a file, or from a file of scenarios/kinds that comes with the program.
/// InputError for what is none.
gap::Kind kind_asked(const std::string& text);

void declare_gap(Command& app, int& status);
void declare_gap_check(Command& gap, int& status);
void declare_gap_import(Command& gap, int& status);
void declare_gap_mission(Command& gap, int& status);
void declare_gap_power(Command& gap, int& status);
void declare_gap_new(Command& gap, int& status);
void declare_gap_record(Command& gap, int& status);
/// `puckloop gap selftest --grammar`: randomly drawn cases. `seed` 0: a fresh one; `of`: class, "" for all.
struct GrammarRequest {
    std::uint64_t cases = 0, seed = 0;
    std::vector<std::size_t> only;
    unsigned workers = 2;
    std::string kind, of;
    bool json = false, keep = false, draw_runs = false, ask_all = false;
    bool power = false;  ///< each case with several numbers of its runs
    std::filesystem::path scratch, svg;
    std::vector<std::string> pool;  ///< results of earlier runs, to be counted in place of new cases
};
int grammar_test(const GrammarRequest& request);
/// Another one each time, from the machine's own randomness; short enough to be typed.
std::uint64_t fresh_seed();

void declare_gap_selftest(Command& gap, int& status);

/// The project's own firmware and recording program, as built.
gap::emulate::Tools emulation_tools();

}  // namespace puckloop::tools
