#pragma once
// The report an experimentalist prints: verdict first, then pictures, evidence and cautions. One HTML text
// with pictures inside, no scripts, nothing from elsewhere, A4.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <string>

namespace puckloop::gap::report {

std::string report_html(const Experiment& experiment, const Verdict& verdict);

/// The posterior-predictive checks of the model that the verdict stands by as one picture (SVG): with the
/// named causes, where there are any. Empty where it has none.
std::string predictive_svg(const Verdict& verdict);

}  // namespace puckloop::gap::report
