#pragma once
// Refusing a run that cannot be used.

#include "base/error.h"
#include "gap/data/experiment.h"

#include <fmt/format.h>

#include <string>

namespace puckloop::gap {

/// Throws InputError, which names the run's file and, where `row` (from 0) is told, the row.
[[noreturn]] inline void refuse(const Experiment& experiment, const Run& run, const std::string& problem,
                                const std::string& expected, long row = -1) {
    throw InputError((experiment.folder / run.file).string(),
                     row < 0 ? std::string() : fmt::format("row {}", row + 1), problem, expected);
}

}  // namespace puckloop::gap
