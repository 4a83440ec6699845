#pragma once
// What became of an [[expect]] table of the scenario.

#include <optional>
#include <string>

namespace puckloop::tools {

struct ExpectationResult {
    std::string name;      ///< what was expected, for people
    std::string stated{};  ///< what its keys say, where the name does not
    std::string place;     ///< of the table in the scenario: "line 12"
    std::string subject;   ///< node, link or robot
    bool met = false;
    std::string why;             ///< what was seen, or that it was not
    std::optional<double> at{};  ///< s: when it was first seen, where that has an instant
};

}  // namespace puckloop::tools
