#pragma once
// report.html: one file, no scripts.

#include "campaigns/engine/campaign.h"

#include <functional>
#include <string>

namespace puckloop::faults {

void write_html(const Results& results);

/// Where the page of a case is, as a link from the report; empty: it has none.
using PageOfCase = std::function<std::string(const Case&)>;
/// `page` empty: of a file, which has no such pages.
std::string html_text(const Results& results, const PageOfCase& page = {});

}  // namespace puckloop::faults
