#include "physics/render/path_file.h"

#include "base/csv.h"
#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>

namespace puckloop::physics {

namespace {

constexpr std::size_t kPathFields = 5;

bool parse(std::string_view line, std::string& name, PathPoint& point) {
    const auto fields = csv_cells(line, ',');
    if (fields.size() != kPathFields) return false;
    name = fields[1];
    return csv_number(fields[0], point.seconds) && csv_number(fields[2], point.x) &&
           csv_number(fields[3], point.y) && csv_number(fields[4], point.heading);
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
