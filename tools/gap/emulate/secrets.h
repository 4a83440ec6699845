#pragma once
// Secret changes of the emulated robot: what is changed, and what the tool must find against the unchanged
// model.

#include <string>
#include <vector>

namespace puckloop::gap::emulate {

struct Secret {
    const char* kind;
    const char* what;                      ///< in plain words
    std::vector<std::string> assignments;  ///< as for set_parameter
    std::vector<std::string> names;        ///< catalogue's names that are right answers
};

/// At least twelve, and for each kind one without any change (no assignment, no name).
const std::vector<Secret>& secrets();

}  // namespace puckloop::gap::emulate
