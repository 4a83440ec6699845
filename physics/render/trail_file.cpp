#include "physics/render/trail_file.h"

#include "base/text/csv.h"
#include "physics/render/result_rows.h"

#include <string>
#include <string_view>

namespace puckloop::physics {

namespace {

struct Row {
    double seconds = 0.0;
    std::string name;
    TrailSquare square;
};

bool parse(const std::vector<std::string_view>& fields, Row& row) {
    constexpr std::size_t kFields = 5;
    if (fields.size() != kFields) return false;
    row.name = fields[1];
    return csv_number(fields[0], row.seconds) && csv_number(fields[2], row.square.x) &&
           csv_number(fields[3], row.square.y) && csv_number(fields[4], row.square.strength);
}

/// The latest rows of one trail.
struct Latest {
    double seconds = -1.0;
    std::vector<TrailSquare> squares;
};

}  // namespace

std::vector<TrailSquare> read_trails(const World& world, const std::filesystem::path& file) {
    const auto& trails = world.virtuals.pheromones;
    std::vector<Latest> latest(trails.size());
    for_each_result_row(file, "a trail", [&](const std::vector<std::string_view>& fields) {
        Row row;
        if (!parse(fields, row)) return false;
        for (std::size_t i = 0; i < trails.size(); ++i) {
            if (trails[i].name != row.name) continue;
            if (row.seconds > latest[i].seconds) latest[i] = {row.seconds, {}};
            row.square.side = trails[i].cell;
            row.square.grey = trails[i].grey;
            latest[i].squares.push_back(row.square);
        }
        return true;
    });
    std::vector<TrailSquare> all;
    for (const Latest& trail : latest)
        all.insert(all.end(), trail.squares.begin(), trail.squares.end());
    return all;
}

}  // namespace puckloop::physics
