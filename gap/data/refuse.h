#pragma once
// Data that cannot be used: one line with place, problem and remedy.

#include "base/error.h"
#include "gap/data/experiment.h"

#include <fmt/format.h>

#include <string>

namespace puckloop::gap {

/// Throws InputError, which names the run's file and, where `row` (from 0) is given, the row.
[[noreturn]] inline void refuse(const Experiment& experiment, const Run& run, const std::string& problem,
                                const std::string& expected, long row = -1) {
    throw InputError((experiment.folder / run.file).string(),
                     row < 0 ? std::string() : fmt::format("row {}", row + 1), problem, expected);
}

/// Of the experiment as a whole: its experiment.toml.
[[noreturn]] inline void refuse(const Experiment& experiment, const std::string& problem,
                                const std::string& expected) {
    throw InputError((experiment.folder / "experiment.toml").string(), "", problem, expected);
}

}  // namespace puckloop::gap
