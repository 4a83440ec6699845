#pragma once
// An experiment of a few short runs with the shipped swarm, for tests of how it is carried out.

#include "tests/end_to_end/kit/workbench.h"

#include <filesystem>
#include <string>

namespace puckloop::tests {

/// Two programs with three seeds each: three robots of scenarios/aggregation.toml for 2.5 s.
std::filesystem::path small_experiment(const Workbench& bench);

/// `puckloop experiment FILE --out NAME` and further words.
Words experiment_words(const Workbench& bench, const std::filesystem::path& file, const std::string& out,
                       const Words& more = {});

}  // namespace puckloop::tests
