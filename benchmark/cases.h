#pragma once
// The cases of `puckloop bench`. docs/bench.md states what each figure means.

#include "benchmark/measures/figure.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

struct BenchOptions {
    std::vector<std::string> cases{"core", "scenario"};
    std::filesystem::path scenario;    ///< of the case "scenario"; empty: the project's hello.toml
    std::filesystem::path image;       ///< of the case "core", on the bare chip as well; empty: none
    std::filesystem::path rab_image;   ///< empty: the project's
    std::filesystem::path peer;        ///< another build of puckloop; empty: none
    std::vector<std::string> program;  ///< of the case "lab20", for original images; empty: none
    std::vector<int> robots{1, 10, 100};
    double simulated_s = 20.0;  ///< of the scenario; dearer runs take a fixed share of it
    double slice_s = 0.4;       ///< wall time of each measurement that has no duration of its own
    unsigned threads = 0;       ///< of runs in one process; 0: as many as the build chooses
    int rounds = 5;
    bool interpret = false;  ///< this build's dsPIC cores translate nothing
};

/// Names of the cases, in the order of the help.
const std::vector<std::string>& bench_cases();
/// A line of help for each, which begins with a line break.
std::string bench_cases_help();

/// Throws InputError and RunError, and InputError if the peer is no program.
std::vector<Figure> measure_cases(const BenchOptions& options);

}  // namespace puckloop::tools
