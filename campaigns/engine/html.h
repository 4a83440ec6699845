#pragma once
// report.html: one file, no scripts.

#include "campaigns/engine/campaign.h"

#include <string>

namespace puckloop::faults {

void write_html(const Results& results);
std::string html_text(const Results& results);

}  // namespace puckloop::faults
