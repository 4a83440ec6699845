#pragma once
// An experiment as analyses get it: read, judged, its clocks put right.

#include "gap/data/experiment.h"

#include <filesystem>

namespace puckloop::gap {

/// Reads `folder`/experiment.toml and the CSV files it names, converts units, and looks for what cannot be
/// used: wrong units, swapped columns, a clock that jumps, constant columns, missing truth, NaN, two robots
/// mixed. What can be used with care becomes a caution. Throws InputError with file and line for the first
/// problem.
Experiment read_experiment(const std::filesystem::path& folder);

/// The same, but every problem found goes to `problems` and reading goes on behind it, as far as it makes
/// sense; clocks are not synchronised, so that it is done at once. Throws where nothing can be read at all.
Experiment survey_experiment(const std::filesystem::path& folder, Problems& problems);

}  // namespace puckloop::gap
