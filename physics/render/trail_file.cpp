#include "physics/render/trail_file.h"

#include "base/csv.h"
#include "base/error.h"

#include <fmt/format.h>

#include <fstream>

namespace puckloop::physics {

namespace {

struct Row {
    double seconds = 0.0;
    std::string name;
    TrailSquare square;
};

bool parse(std::string_view line, Row& row) {
    constexpr std::size_t kFields = 5;
    const auto fields = csv_cells(line, ',');
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
    std::ifstream in(file);
    if (!in) throw RunError(fmt::format("cannot read {}", file.string()));
    const auto& trails = world.virtuals.pheromones;
    std::vector<Latest> latest(trails.size());
    std::string line;
    std::getline(in, line);  // header
    for (int number = 2; std::getline(in, line); ++number) {
        Row row;
        if (!parse(line, row)) {
            if (in.peek() == std::ifstream::traits_type::eof()) break;
            throw RunError(fmt::format("{}: line {}: not a row of a trail", file.string(), number));
        }
        for (std::size_t i = 0; i < trails.size(); ++i) {
            if (trails[i].name != row.name) continue;
            if (row.seconds > latest[i].seconds) latest[i] = {row.seconds, {}};
            row.square.side = trails[i].cell;
            row.square.grey = trails[i].grey;
            latest[i].squares.push_back(row.square);
        }
    }
    std::vector<TrailSquare> all;
    for (const Latest& trail : latest)
        all.insert(all.end(), trail.squares.begin(), trail.squares.end());
    return all;
}

}  // namespace puckloop::physics
