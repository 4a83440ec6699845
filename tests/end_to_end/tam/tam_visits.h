#pragma once
// What robots did at TAMs in a run of scenarios/tam.toml or one like it.

#include "tests/end_to_end/kit/workbench.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace puckloop::tests {

struct RobotVisits {
    std::vector<double> entered;  ///< s
    std::set<int> heard;          ///< words that its program printed
    bool left = false;            ///< it has been inside, and out again
};

/// Of robots "robot0" to the one before "robot<robots>". Inside is within 3 cm of a booth's middle, along and
/// across.
std::vector<RobotVisits> visits_of(const Workbench& bench, const std::string& run, int robots);

/// The coordinator's table: values of `event` for each TAM, in order.
std::map<std::string, std::vector<std::string>> values_of(const Workbench& bench, const std::string& run,
                                                          const std::string& event);

}  // namespace puckloop::tests
