#pragma once
// results.csv, and the summary on the terminal.

#include "campaigns/experiment/analysis.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::swarm {

/// One row per run that is done, in the order of their numbers; nothing that depends on who ran what when.
std::string table_text(const Findings& findings);

std::string summary(const Findings& findings, const std::vector<Cell>& cells,
                    const std::vector<Comparison>& comparisons, const std::optional<Agreement>& agreement);

/// "[low, high]", with the coverage where that is less than 95 %.
std::string interval_text(const statistics::Interval& interval);

/// "0.031", "< 0.001".
std::string p_text(double p);

}  // namespace puckloop::swarm
