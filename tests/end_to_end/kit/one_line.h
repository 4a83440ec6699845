#pragma once
// What every refusal and failure must look like: right status, one line, soon.

#include "tests/end_to_end/kit/workbench.h"

namespace puckloop::tests {

/// Checks (Catch2) status and time, and that standard error is one line which begins with "puckloop: " and
/// contains `words`.
void check_one_line(const Ended& ended, int status, const Words& words, double within_s = 30.0);

}  // namespace puckloop::tests
