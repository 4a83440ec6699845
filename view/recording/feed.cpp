#include "view/recording/feed.h"

#include "base/text/csv.h"
#include "view/recording/bytes.h"

#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace puckloop::view {

namespace {

void append_part(std::string& out, Feed::Part part, std::string_view bytes) {
    append_number(out, static_cast<std::uint8_t>(part));
    append_number(out, static_cast<std::uint32_t>(bytes.size()));
    out += bytes;
}

}  // namespace

std::string Feed::next() {
    std::uint64_t epoch = 0;
    std::string state;
    do {
        epoch = run_.epoch();
        state = run_.state();
    } while (epoch != run_.epoch());
    std::string out;
    if (state != state_) {
        append_part(out, Part::State, state);
        state_ = std::move(state);
    }
    if (epoch != epoch_) {
        epoch_ = epoch;
        read_.fill(0);
        for (auto& names : numbers_)
            names.clear();
        known_ = 0;
    }
    rows_of(true, out);
    rows_of(false, out);
    return out;
}

void Feed::rows_of(bool robots, std::string& out) {
    const auto file = static_cast<std::size_t>(robots);
    const std::string text = recording_.tail(static_cast<Recording::Rows>(file), read_[file]);
    read_[file] += text.size();
    std::vector<std::uint16_t> numbers;
    std::vector<double> times;
    std::array<std::vector<float>, 3> places;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin);
        const auto cells = csv_cells(std::string_view(text).substr(begin, end - begin), ',');
        begin = end + 1;
        std::array<double, 3> place{};
        double time = 0.0;
        bool row = cells.size() > places.size() + 1 && csv_number(cells[0], time);
        for (std::size_t i = 0; row && i < place.size(); ++i)
            row = csv_number(cells[i + 2], place[i]);
        if (!row || known_ == std::numeric_limits<std::uint16_t>::max()) continue;  // the header
        const auto [named, fresh] = numbers_[file].try_emplace(std::string(cells[1]), known_);
        if (fresh) {
            std::string name;
            append_number(name, static_cast<std::uint8_t>(file));
            append_number(name, known_++);
            append_part(out, Part::Name, name.append(cells[1]));
        }
        numbers.push_back(named->second);
        times.push_back(time);
        for (std::size_t i = 0; i < place.size(); ++i)
            places[i].push_back(static_cast<float>(place[i]));
    }
    if (numbers.empty()) return;
    std::string rows;
    append_number(rows, static_cast<std::uint32_t>(numbers.size()));
    append_numbers(rows, std::span<const std::uint16_t>(numbers));
    append_numbers(rows, std::span<const double>(times));
    for (const auto& values : places)
        append_numbers(rows, std::span<const float>(values));
    append_part(out, Part::Rows, rows);
}

}  // namespace puckloop::view
