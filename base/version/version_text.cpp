#include "base/version/version.h"

namespace puckloop {

std::string version_text() {
    const Version& version = program_version();
    if (version.commit.empty()) return version.number;
    return version.number + " (commit " + version.commit + (version.modified ? ", modified)" : ")");
}

}  // namespace puckloop
