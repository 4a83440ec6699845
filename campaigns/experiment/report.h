#pragma once
// report.html of an experiment.

#include "campaigns/experiment/analysis.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::swarm {

/// One page without scripts and without other files.
std::string report_html(const Findings& findings, const std::vector<Cell>& cells,
                        const std::vector<Comparison>& comparisons, const std::optional<Agreement>& agreement,
                        const std::filesystem::path& against);

}  // namespace puckloop::swarm
