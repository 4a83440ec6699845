#pragma once
// An experiment that was run: what its results folder holds, and one of its runs once more.

#include "campaigns/experiment/analysis.h"
#include "campaigns/experiment/report.h"

#include <filesystem>
#include <string>

namespace puckloop::swarm {

/// What an existing results folder holds. Throws InputError where it is none, or its experiment file is gone.
Findings read_findings(const std::filesystem::path& out);

/// Its report, with links to the pages of runs; without what `--against` set beside it.
std::string served_report(const Findings& findings, const PageOfRun& page);

/// Carries a run out again with all its files in `folder`, which it empties. Throws InputError: there is no
/// such run, or `folder` holds other things.
RunResult run_again(const Findings& findings, int id, const std::filesystem::path& folder);

}  // namespace puckloop::swarm
