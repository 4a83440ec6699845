#pragma once
// The report an experimentalist prints: verdict first, then pictures, evidence and cautions. One HTML text
// with pictures inside, no scripts, nothing from elsewhere, A4.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <filesystem>
#include <string>

namespace puckloop::gap::report {

std::string report_html(const Experiment& experiment, const Verdict& verdict);

/// Writes report_html() to `file`; RunError if that fails.
void write_report(const Experiment& experiment, const Verdict& verdict, const std::filesystem::path& file);

}  // namespace puckloop::gap::report
