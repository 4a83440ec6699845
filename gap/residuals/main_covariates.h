#pragma once
// What a kind of experiment is looked at against: declared once, before any data.

#include "gap/data/experiment.h"
#include "gap/stats/structure.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// Of `all` (covariates_of) those that an experimentalist would draw this observable against, at most three,
/// the first one first; the row's number where there is none.
std::vector<stats::Covariate> main_covariates(const Experiment& experiment, const std::string& observable,
                                              const std::vector<stats::Covariate>& all,
                                              const std::vector<std::uint32_t>& row);

/// "distance (m)": a covariate as covariates_of() names it, with its unit.
std::string covariate_label(const std::string& name);
/// "reading (counts)"
std::string with_unit(const std::string& name, const std::string& unit);

}  // namespace puckloop::gap
