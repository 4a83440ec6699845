#include "tools/guide/first_line.h"

#include <fstream>
#include <string_view>

namespace puckloop::tools {

namespace {

/// `line` of an XML file, if it begins with a comment: up to its end or its first sentence's.
std::string xml_comment(std::string_view line) {
    constexpr std::string_view kBegin = "<!--";
    if (!line.starts_with(kBegin)) return {};
    line.remove_prefix(kBegin.size());
    line = line.substr(0, line.find("-->"));
    line = line.substr(0, line.find(". "));
    const std::size_t begin = line.find_first_not_of(' ');
    return begin == std::string_view::npos ? "" : std::string(line.substr(begin));
}

}  // namespace

std::string first_comment(const std::filesystem::path& file) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with("<?xml")) continue;
        if (std::string text = xml_comment(line); !text.empty()) return text;
        if (line.empty() || line.front() != '#') break;
        const std::size_t begin = line.find_first_not_of("# ");
        // "#:schema FILE" is for editors.
        if (begin == std::string::npos || line.starts_with("#:")) continue;
        return line.substr(begin);
    }
    return {};
}

}  // namespace puckloop::tools
