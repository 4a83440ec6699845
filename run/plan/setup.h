#pragma once
// From a scenario to the nodes and links of a run.

#include "cosim/conductor.h"
#include "run/options.h"
#include "scenarios/reader/scenario.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

struct RunSetup {
    scenarios::Scenario scenario;
    std::string scenario_sha256{};  ///< of its file, as it was read
    std::filesystem::path out;
    std::vector<cosim::NodeSpec> nodes;
    std::vector<cosim::LinkSpec> links;
    std::string control{};                ///< socket at which the world takes commands; empty: none
    std::vector<std::string> warnings{};  ///< what looks like a mistake
    std::string cache_unused{};           ///< why no boot is taken from the cache; empty: no such reason
    std::filesystem::path save_state{};   ///< where the boards' states at `save_at` go; empty: nowhere
    cosim::Time save_at = 0;
    std::filesystem::path from{};  ///< snapshot that the run goes on from; empty: none
    cosim::Time from_time = 0;     ///< of that
    cosim::Time ready = 0;         ///< in real time: the boards are ready, the wall clock counts from here
};

/// Reads the scenario, applies the request's changes and plans nodes and links. Throws InputError for
/// everything that can be seen before the run: options, files, images that do not fit.
RunSetup set_up(const RunRequest& request);

}  // namespace puckloop::tools
