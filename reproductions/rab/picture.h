#pragma once
// The readings of emulated boards as a picture (SVG): strength beside the published table, distance as a host
// works it out, bearing error; one column a distance.

#include "reproductions/rab/summary.h"

namespace puckloop::tools {

/// `caption`: what was measured, one line.
std::string rab_picture(const std::vector<RabSummary>& summary, const std::string& caption);

}  // namespace puckloop::tools
