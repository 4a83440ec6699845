#pragma once
// Two runs are the same when nothing they recorded distinguishes them.

#include "tests/end_to_end/kit/workbench.h"

namespace puckloop::tests {

/// Checks (Catch2) that runs `a` and `b` left the same trace fingerprint and the same bytes in every CSV
/// file.
void check_same_run(const Workbench& bench, const std::string& a, const std::string& b);

}  // namespace puckloop::tests
