#include "physics/render/path_file.h"

#include "base/text/csv.h"
#include "physics/render/result_rows.h"

#include <algorithm>
#include <string_view>

namespace puckloop::physics {

namespace {

constexpr std::size_t kPathFields = 5;

bool parse(const std::vector<std::string_view>& fields, std::string& name, PathPoint& point) {
    if (fields.size() != kPathFields) return false;
    name = fields[1];
    return csv_number(fields[0], point.seconds) && csv_number(fields[2], point.x) &&
           csv_number(fields[3], point.y) && csv_number(fields[4], point.heading);
}

}  // namespace

Paths read_paths(const std::filesystem::path& file) {
    Paths paths;
    std::string name;
    for_each_result_row(file, "a path", [&](const std::vector<std::string_view>& fields) {
        PathPoint point;
        if (!parse(fields, name, point)) return false;
        auto path = std::find_if(paths.begin(), paths.end(), [&](const auto& p) { return p.first == name; });
        if (path == paths.end()) path = paths.insert(paths.end(), {name, {}});
        path->second.push_back(point);
        return true;
    });
    return paths;
}

}  // namespace puckloop::physics
