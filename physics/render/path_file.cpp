#include "physics/render/path_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <string_view>

namespace puckloop::physics {

namespace {

constexpr std::size_t kFields = 5;

bool parse(std::string_view line, std::string& name, PathPoint& point) {
    std::array<std::string_view, kFields> fields;
    for (std::size_t i = 0; i < kFields; ++i) {
        const auto comma = i + 1 < kFields ? line.find(',') : line.size();
        if (comma == std::string_view::npos) return false;
        fields[i] = line.substr(0, comma);
        line.remove_prefix(std::min(comma + 1, line.size()));
    }
    const auto number = [](std::string_view text, double& value) {
        const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
        return result.ec == std::errc() && result.ptr == text.data() + text.size();
    };
    name = fields[1];
    return number(fields[0], point.seconds) && number(fields[2], point.x) && number(fields[3], point.y) &&
           number(fields[4], point.heading);
}

}  // namespace

Paths read_paths(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw RunError(fmt::format("cannot read {}", file.string()));
    Paths paths;
    std::string line;
    std::string name;
    std::getline(in, line);  // header
    for (int number = 2; std::getline(in, line); ++number) {
        PathPoint point;
        if (!parse(line, name, point)) {
            if (in.peek() == std::ifstream::traits_type::eof()) break;
            throw RunError(fmt::format("{}: line {}: not a row of a path", file.string(), number));
        }
        auto path = std::find_if(paths.begin(), paths.end(), [&](const auto& p) { return p.first == name; });
        if (path == paths.end()) path = paths.insert(paths.end(), {name, {}});
        path->second.push_back(point);
    }
    return paths;
}

}  // namespace puckloop::physics
