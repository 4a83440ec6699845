#pragma once
// Whether frames that the scenario expects were on the lines, by the trace that the run wrote.

#include "run/report/expectation_result.h"
#include "scenarios/description/expectation.h"

#include <filesystem>
#include <vector>

namespace puckloop::tools {

/// Those of `all` that are of frames, into the results of the same index. Throws InputError: the trace in
/// `out` cannot be read.
void judge_frames(const std::filesystem::path& out, const std::vector<scenarios::Expectation>& all,
                  std::vector<ExpectationResult>& results);

}  // namespace puckloop::tools
