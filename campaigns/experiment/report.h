#pragma once
// report.html of an experiment.

#include "campaigns/experiment/analysis.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::swarm {

/// Where the page of a run is, as a link from the report.
using PageOfRun = std::function<std::string(const Run&)>;

/// One page without scripts and without other files. `page` empty: of a file, which has no pages of runs.
std::string report_html(const Findings& findings, const std::vector<Cell>& cells,
                        const std::vector<Comparison>& comparisons, const std::optional<Agreement>& agreement,
                        const std::filesystem::path& against, const PageOfRun& page = {});

}  // namespace puckloop::swarm
