#pragma once
// One run of an experiment, and what is kept of it.

#include "campaigns/experiment/experiment_file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace puckloop::swarm {

struct RunResult {
    std::optional<double> score;  ///< none: the run failed, or counted nothing
    bool more_is_better = true;   ///< by the run's mission
    std::string failed;           ///< why it failed, one line; empty: it did not
    double simulated = 0.0;       ///< s
    double wall = 0.0;            ///< s; the only value that is not the same each time
    std::string trace;            ///< SHA-256
};

nlohmann::json to_json(const RunResult& result);
RunResult result_from_json(const nlohmann::json& text);

/// Reads scenario, images and programs of a run as its worker will. Throws InputError, with the line of its
/// program, or of its condition where that is not the only one.
void check_run(const Experiment& experiment, const Run& run, const std::filesystem::path& folder);

/// The files that its results depend on, with hashes, and the build.
std::string identity_of(const Experiment& experiment);

/// Runs it in a process of its own with all files in `folder`, which it replaces; boots of boards are kept in
/// `boots`. A run that failed is a result. Throws RunError if it could not be made.
RunResult execute(const Experiment& experiment, const Run& run, const std::filesystem::path& folder,
                  const std::filesystem::path& boots);

}  // namespace puckloop::swarm
