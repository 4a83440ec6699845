#include "campaigns/experiment/reference.h"

#include "base/error.h"
#include "base/text/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

namespace puckloop::swarm {

namespace {

std::optional<std::size_t> column_of(const std::vector<std::string_view>& header, std::string_view name) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) return std::nullopt;
    return static_cast<std::size_t>(found - header.begin());
}

}  // namespace

Reference read_reference(const std::filesystem::path& file) {
    constexpr const char* kExpected = "a header with the columns program and score, one row per run";
    std::ifstream in(file);
    if (!in) throw InputError(file.string(), "", std::strerror(errno), "a CSV file of scores");
    Reference reference;
    reference.file = file;
    std::string line;
    if (!std::getline(in, line)) throw InputError(file.string(), "line 1", "the file is empty", kExpected);
    const std::string header_line = line;
    const std::vector<std::string_view> header = csv_cells(header_line, ',');
    const auto program = column_of(header, "program"), score = column_of(header, "score"),
               condition = column_of(header, "condition");
    for (const auto& [column, name] : {std::pair{program, "program"}, std::pair{score, "score"}})
        if (!column)
            throw InputError(file.string(), "line 1", fmt::format("there is no column '{}'", name),
                             kExpected);
    reference.has_conditions = condition.has_value();
    for (int number = 2; std::getline(in, line); ++number) {
        if (csv_trimmed(line).empty()) continue;
        const std::string place = fmt::format("line {}", number);
        const std::vector<std::string_view> cells = csv_cells(line, ',');
        if (cells.size() != header.size())
            throw InputError(file.string(), place,
                             fmt::format("it has {} cells, the header {}", cells.size(), header.size()),
                             kExpected);
        if (cells[*score].empty()) continue;
        double value = 0.0;
        if (!csv_number(cells[*score], value) || !std::isfinite(value))
            throw InputError(file.string(), place, fmt::format("'{}' is no score", cells[*score]),
                             "a number");
        const std::string under(condition ? cells[*condition] : std::string_view());
        reference.scores[{std::string(cells[*program]), under}].push_back(value);
    }
    if (reference.scores.empty())
        throw InputError(file.string(), "", "it has no row with a score", kExpected);
    return reference;
}

}  // namespace puckloop::swarm
