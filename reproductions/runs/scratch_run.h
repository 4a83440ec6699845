#pragma once
// A run of a scenario that an experiment writes: in a folder of its own, in this process, to its end.

#include <filesystem>

namespace puckloop::tools {

/// An empty folder for it; what was in it goes. Throws InputError if it cannot be made.
void empty_folder(const std::filesystem::path& folder);

/// Runs `scenario`, with physical parameters of `overlay` over its own where that is not empty. Returns the
/// folder of its results, beside it. Throws InputError for what the scenario reader refuses, RunError where
/// the run did not reach its end, or was interrupted.
std::filesystem::path run_beside(const std::filesystem::path& scenario,
                                 const std::filesystem::path& overlay = {});

}  // namespace puckloop::tools
