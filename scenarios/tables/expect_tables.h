#pragma once
// The tables [[expect]] of a scenario.

#include "scenarios/description/expectation.h"
#include "scenarios/values/reader.h"

#include <vector>

namespace puckloop::scenarios {

/// In the order of the file. Nodes and links are not looked up: they are known when the run is planned.
/// Throws InputError with file and line.
std::vector<Expectation> read_expectations(Reader& top);

}  // namespace puckloop::scenarios
