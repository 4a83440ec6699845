#pragma once
// The version of this build: one number, CMake's, and the commit that it was built from.

#include <string>

namespace puckloop {

struct Version {
    std::string number;     ///< "0.1.0"
    std::string commit;     ///< 12 hexadecimal digits; empty: built outside of a repository
    bool modified = false;  ///< tracked sources differed from the commit
};

/// Written at each build (cmake/WriteVersion.cmake).
const Version& program_version();

/// "0.1.0 (commit 0123456789ab, modified)"
std::string version_text();

}  // namespace puckloop
