#pragma once
// `allow` of [run]: failures of a run that went on to its end which leave it successful
// (run/report/failures.h).

#include "scenarios/values/reader.h"

#include <string>
#include <vector>

namespace puckloop::scenarios {

/// Of "program", "silent_line" and "hung". Throws InputError for another one.
std::vector<std::string> read_allowed(Reader& run);

}  // namespace puckloop::scenarios
