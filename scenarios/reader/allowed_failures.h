#pragma once
// `allow` of [run]: failures of a run that went on to its end which leave it successful
// (run/report/failures.h).

#include "scenarios/reader/reader.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::scenarios {

/// Of "program", "silent_line" and "hung". Throws InputError for another one.
std::vector<std::string> read_allowed(Reader& run);

/// Those of a scenario's file; none where it is not there. Throws InputError.
std::vector<std::string> allowed_failures(const std::filesystem::path& file);

}  // namespace puckloop::scenarios
