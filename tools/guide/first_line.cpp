#include "tools/guide/first_line.h"

#include <fstream>

namespace puckloop::tools {

std::string first_comment(const std::filesystem::path& file) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line.front() != '#') break;
        const std::size_t begin = line.find_first_not_of("# ");
        // "#:schema FILE" is for editors.
        if (begin == std::string::npos || line.starts_with("#:")) continue;
        return line.substr(begin);
    }
    return {};
}

}  // namespace puckloop::tools
