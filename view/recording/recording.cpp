#include "view/recording/recording.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"
#include "base/text/csv.h"
#include "physics/render/arena_file.h"
#include "physics/render/result_rows.h"
#include "physics/world/booth_record.h"
#include "view/recording/arena_json.h"
#include "view/recording/bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kFolder = "the results folder of a run (`puckloop run SCENARIO --out DIR`)";
constexpr int kReportFormat = 1;         // run/report/report.h
constexpr std::size_t kMostNoted = 100;  // warnings of a report that the page lists

/// Links that carried bytes: `name`, `ends`.
ordered_json serial_lines(const ordered_json& report) {
    ordered_json lines = ordered_json::array();
    const auto links = report.find("links");
    if (links == report.end() || !links->is_object()) return lines;
    for (const auto& [name, link] : links->items()) {
        const auto carried = [&link = link](const char* side) {
            const auto found = link.find(side);
            return found != link.end() && found->is_object() && found->contains("uart_frames");
        };
        if (!link.is_object() || (!carried("from_a") && !carried("from_b"))) continue;
        const auto node = [&link = link](const char* end) {
            const auto found = link.find(end);
            const std::string place =
                found != link.end() && found->is_string() ? found->get<std::string>() : "";
            return place.substr(0, place.rfind('.'));
        };
        lines.push_back({{"name", name}, {"ends", {node("a"), node("b")}}});
    }
    return lines;
}

bool is_there(const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored);
}

std::string string_of(const ordered_json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

Recording::Recording(fs::path folder, bool live) : folder_(std::move(folder)), live_(live) {
    std::error_code error;
    if (!fs::exists(folder_, error)) throw InputError(folder_.string(), "", "no such folder", kFolder);
    if (!fs::is_directory(folder_, error)) throw InputError(folder_.string(), "", "is no folder", kFolder);
    if (!is_there(folder_ / "trajectory.csv") && !is_there(folder_ / "trace.csv"))
        throw InputError(folder_.string(), "", "has neither trajectory.csv nor trace.csv", kFolder);
    read_report();
    read_arena();
    read_paths();
    read_booths();
    if (!is_there(folder_ / "trace.csv"))
        notes_.emplace_back("trace.csv is not there, so no frames are shown: run the scenario again");
}

void Recording::read_report() {
    const fs::path file = folder_ / "report.json";
    const std::string text = read_whole_file(file).value_or("");
    if (text.empty() && live_) return;
    if (text.empty()) {
        notes_.emplace_back(
            "report.json is not there: the run goes on, or was killed. What it recorded is shown");
        return;
    }
    const auto json = ordered_json::parse(text, nullptr, false);
    if (!json.is_object()) throw InputError(file.string(), "", "is damaged", "run the scenario again");
    const auto format = json.find("format");
    if (format == json.end() || !format->is_number_integer() || *format != kReportFormat)
        throw InputError(file.string(), "format",
                         format == json.end() ? "is not there" : "is " + format->dump(),
                         fmt::format("{}: run the scenario again with this puckloop, or view it with the one "
                                     "that recorded it",
                                     kReportFormat));
    if (const auto end = json.find("simulated_s"); end != json.end() && end->is_number())
        duration_s_ = std::clamp(end->get<double>(), 0.0, 9e6);
    ordered_json shown{{"scenario", fs::path(string_of(json, "scenario")).filename().string()},
                       {"ended_why", string_of(json, "ended_why")},
                       {"trace_sha256", string_of(json, "trace_sha256")}};
    for (const char* key : {"seed", "success", "simulated_s", "wall_s"})
        if (json.contains(key)) shown[key] = json[key];
    ordered_json warnings = ordered_json::array();
    if (const auto all = json.find("warnings"); all != json.end() && all->is_array())
        for (const auto& one : *all)
            if (warnings.size() < kMostNoted && one.is_string()) warnings.push_back(one);
    if (const auto all = json.find("failures"); all != json.end() && all->is_array())
        for (const auto& one : *all)
            if (warnings.size() < kMostNoted && one.is_object())
                warnings.push_back(fmt::format("{}: {}", string_of(one, "node"), string_of(one, "text")));
    shown["warnings"] = warnings;
    shown["serial"] = serial_lines(json);
    report_ = shown.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

void Recording::read_arena() {
    const fs::path file = folder_ / "arena.json";
    if (!is_there(file)) {
        notes_.emplace_back(
            "arena.json is not there, so walls and things are not drawn: an older puckloop made "
            "this folder; run the scenario again");
        return;
    }
    const physics::World world = physics::read_arena_file(file);
    arena_ = arena_json(world);
    for (const physics::Pheromone& trail : world.virtuals.pheromones)
        trails_.push_back(trail.name);
    for (const physics::Robot& robot : world.robots)
        stations_.push_back(robot.name);
    robots_ = stations_.size();
    for (const physics::Booth& booth : world.booths)
        stations_.push_back(booth.name);
}

void Recording::read_paths() {
    const fs::path file = folder_ / "trajectory.csv";
    physics::Paths robots;
    if (is_there(file))
        robots = physics::read_paths(file);
    else
        notes_.emplace_back("trajectory.csv is not there, so robots are not drawn: run the scenario again");
    if (arena_.empty()) {
        for (const auto& [name, points] : robots)
            stations_.push_back(name);
        robots_ = stations_.size();
    }
    robot_paths_ = robots.size();
    paths_ = std::move(robots);
    if (is_there(folder_ / "objects.csv")) {
        physics::Paths objects = physics::read_paths(folder_ / "objects.csv");
        paths_.insert(paths_.end(), std::make_move_iterator(objects.begin()),
                      std::make_move_iterator(objects.end()));
    }
    for (const auto& [name, points] : paths_)
        if (!points.empty()) duration_s_ = std::max(duration_s_, points.back().seconds);
}

void Recording::read_booths() {
    if (!is_there(folder_ / "tams.csv")) return;
    ordered_json all = ordered_json::object();
    for (const physics::BoothColours& booth : physics::read_booth_colours(folder_ / "tams.csv")) {
        ordered_json changes = ordered_json::array();
        std::array<double, 3> last{-1.0, -1.0, -1.0};
        for (const physics::BoothColour& colour : booth.colours) {
            const std::array now{colour.red, colour.green, colour.blue};
            if (now == last) continue;
            last = now;
            changes.push_back({colour.seconds, colour.red, colour.green, colour.blue});
        }
        all[booth.name] = std::move(changes);
    }
    booths_ = all.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::vector<std::string> Recording::sensor_columns() const {
    std::ifstream in(folder_ / "sensors.csv");
    std::string line;
    std::vector<std::string> columns;
    if (!in || !std::getline(in, line)) return columns;
    for (const std::string_view cell : csv_cells(line, ','))
        columns.emplace_back(cell);
    if (columns.size() < 3 || columns[0] != "t_s" || columns[1] != "robot") return {};
    columns.erase(columns.begin(), columns.begin() + 2);
    return columns;
}

std::string Recording::head() const {
    ordered_json head{{"format", 1}, {"live", live_}, {"duration_s", duration_s_}, {"notes", notes_}};
    head["report"] = report_.empty() ? ordered_json() : ordered_json::parse(report_);
    head["arena"] = arena_.empty() ? ordered_json() : ordered_json::parse(arena_);
    head["stations"] = stations_;
    head["robots"] = robots_;
    ordered_json paths = ordered_json::array();
    for (std::size_t i = 0; i < paths_.size(); ++i)
        paths.push_back({{"name", paths_[i].first}, {"robot", i < robot_paths_}});
    head["paths"] = paths;
    head["booths"] = booths_.empty() ? ordered_json::object() : ordered_json::parse(booths_);
    head["sensors"] = sensor_columns();
    return head.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string Recording::poses() const {
    std::string out;
    for (const auto& [name, points] : paths_) {
        append_number(out, static_cast<std::uint32_t>(points.size()));
        for (const auto part : {&physics::PathPoint::seconds, &physics::PathPoint::x, &physics::PathPoint::y,
                                &physics::PathPoint::heading})
            for (const physics::PathPoint& point : points)
                append_number(out, static_cast<float>(point.*part));
    }
    return out;
}

std::string Recording::trails() const {
    std::vector<double> times;
    std::vector<std::uint16_t> of;
    std::array<std::vector<float>, 3> values;
    const fs::path file = folder_ / "pheromones.csv";
    if (!trails_.empty() && is_there(file))
        physics::for_each_result_row(file, "a trail", [&](const std::vector<std::string_view>& cells) {
            double time = 0.0;
            std::array<double, 3> square{};
            const auto trail = cells.size() == square.size() + 2
                                   ? std::find(trails_.begin(), trails_.end(), cells[1])
                                   : trails_.end();
            bool row = trail != trails_.end() && csv_number(cells[0], time);
            for (std::size_t i = 0; row && i < square.size(); ++i)
                row = csv_number(cells[i + 2], square[i]);
            if (!row || times.size() >= kMostSquares) return row;
            times.push_back(time);
            of.push_back(static_cast<std::uint16_t>(trail - trails_.begin()));
            for (std::size_t i = 0; i < square.size(); ++i)
                values[i].push_back(static_cast<float>(square[i]));
            return true;
        });
    std::string out;
    append_number(out, static_cast<std::uint32_t>(times.size()));
    append_number(out, std::uint32_t{0});
    append_numbers(out, std::span<const double>(times));
    append_numbers(out, std::span<const std::uint16_t>(of));
    for (const auto& part : values)
        append_numbers(out, std::span<const float>(part));
    return out;
}

std::string Recording::tail(Rows rows, std::size_t from) const {
    constexpr std::array kFiles{"objects.csv", "trajectory.csv", "tracker.csv"};
    std::ifstream in(folder_ / kFiles[static_cast<std::size_t>(rows)], std::ios::binary);
    if (!in || !in.seekg(0, std::ios::end)) return {};
    const auto size = static_cast<std::size_t>(in.tellg());
    if (size <= from || !in.seekg(static_cast<std::streamoff>(from))) return {};
    std::string text(std::min(size - from, kMostTail), '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    const std::size_t end = text.rfind('\n');
    text.resize(end == std::string::npos ? 0 : end + 1);
    return text;
}

std::string Recording::sensors(std::size_t robot) const {
    const std::size_t columns = sensor_columns().size();
    std::vector<double> times;
    std::vector<std::vector<float>> values(columns);
    const fs::path file = folder_ / "sensors.csv";
    std::ifstream in(file);
    std::string line;
    const std::string name = robot < robots_ ? stations_[robot] : std::string();
    // Every so many-th row: when there are too many, every second one of those so far goes.
    std::size_t stride = 1, seen = 0;
    if (columns > 0 && !name.empty()) std::getline(in, line);
    for (std::size_t number = 2; columns > 0 && !name.empty() && std::getline(in, line); ++number) {
        const std::size_t first = line.find(',');
        const std::size_t second = first == std::string::npos ? first : line.find(',', first + 1);
        const bool broken = second == std::string::npos;
        if (!broken && std::string_view(line).substr(first + 1, second - first - 1) != name) continue;
        if (!broken && seen++ % stride != 0) continue;
        const auto cells = csv_cells(line, ',');
        std::vector<double> row;
        double value = 0.0;
        for (std::size_t i = 0; !broken && i < cells.size(); ++i)
            if (i != 1 && csv_number(cells[i], value)) row.push_back(value);
        if (row.size() != columns + 1) {
            if (in.peek() == std::ifstream::traits_type::eof()) break;  // the run was killed
            throw RunError(fmt::format("{}: line {}: not a row of sensor values", file.string(), number));
        }
        times.push_back(row[0]);
        for (std::size_t i = 0; i < columns; ++i)
            values[i].push_back(static_cast<float>(row[i + 1]));
        if (times.size() < kMostRows) continue;
        stride *= 2;
        const auto every_second = [](auto& column) {
            for (std::size_t i = 0; 2 * i < column.size(); ++i)
                column[i] = column[2 * i];
            column.resize((column.size() + 1) / 2);
        };
        every_second(times);
        for (auto& column : values)
            every_second(column);
    }
    std::string out;
    append_number(out, static_cast<std::uint32_t>(times.size()));
    append_number(out, static_cast<std::uint32_t>(columns + 1));
    append_numbers(out, std::span<const double>(times));
    for (const auto& column : values)
        append_numbers(out, std::span(column));
    return out;
}

}  // namespace puckloop::view
