#include "gap/mission/track.h"

#include "base/error.h"
#include "base/quantile.h"
#include "base/text/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>

namespace puckloop::gap::mission {

namespace {

constexpr double kWindow = 0.5;     // s
constexpr double kStanding = 0.01;  // m/s
constexpr double kTurning = 0.5;    // rad/s: above it a robot turns on purpose
constexpr double kClosest = 0.05;   // share of distances that is called an approach
constexpr std::size_t kFewest = 4;  // windows

struct Columns {
    std::size_t t = 0, robot = 0, x = 0, y = 0, heading = 0;
    bool has_heading = false;
};

Columns columns_of(const std::string& header, const std::filesystem::path& file) {
    const auto cells = csv_cells(header, ',');
    const auto find = [&](std::string_view name) {
        return static_cast<std::size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin());
    };
    Columns columns{find("t_s"), find("robot"), find("x_m"), find("y_m"), find("theta_rad")};
    for (const auto& [at, name] : {std::pair(columns.t, "t_s"), std::pair(columns.robot, "robot"),
                                   std::pair(columns.x, "x_m"), std::pair(columns.y, "y_m")})
        if (at == cells.size())
            throw InputError(file.string(), "line 1", fmt::format("has no column {}", name),
                             "t_s, robot, x_m, y_m, theta_rad");
    columns.has_heading = columns.heading < cells.size();
    return columns;
}

/// Where a way is at `time`, between two of its rows; false outside it or in a hole of more than a window.
bool place_at(const Way& way, double time, double& x, double& y, double& heading) {
    const auto after = std::lower_bound(way.t.begin(), way.t.end(), time);
    if (after == way.t.end()) return false;
    const auto j = static_cast<std::size_t>(after - way.t.begin());
    const std::size_t i = way.t[j] == time || j == 0 ? j : j - 1;
    if (j == 0 && way.t[0] > time) return false;
    const double gap = way.t[j] - way.t[i];
    if (gap > kWindow) return false;
    const double share = gap > 0 ? (time - way.t[i]) / gap : 0.0;
    x = way.x[i] + share * (way.x[j] - way.x[i]);
    y = way.y[i] + share * (way.y[j] - way.y[i]);
    if (!way.heading.empty())
        heading =
            way.heading[i] + share * std::remainder(way.heading[j] - way.heading[i], 2 * std::numbers::pi);
    return true;
}

struct Mean {
    double sum = 0.0;
    std::size_t count = 0;
    void add(double value) {
        sum += value;
        ++count;
    }
    double value() const {
        return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
    }
};

/// All robots at one instant.
struct Instant {
    std::vector<bool> there;
    std::vector<double> x, y, heading;
};

Instant instant(const std::vector<Way>& ways, double time) {
    const std::size_t n = ways.size();
    Instant now{std::vector<bool>(n), std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
    for (std::size_t i = 0; i < n; ++i)
        now.there[i] = place_at(ways[i], time, now.x[i], now.y[i], now.heading[i]);
    return now;
}

/// The swarm's middle; false with fewer than two robots.
bool middle(const Instant& now, double& x, double& y) {
    Mean mean_x, mean_y;
    for (std::size_t i = 0; i < now.there.size(); ++i) {
        if (!now.there[i]) continue;
        mean_x.add(now.x[i]);
        mean_y.add(now.y[i]);
    }
    x = mean_x.value();
    y = mean_y.value();
    return mean_x.count >= 2;
}

}  // namespace

std::vector<Way> read_track(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw InputError(file.string(), "", "cannot be read", "the track of a run");
    std::string line;
    if (!std::getline(in, line)) throw InputError(file.string(), "line 1", "is empty", "a header");
    const Columns columns = columns_of(line, file);
    std::map<std::string, std::size_t, std::less<>> places;
    std::vector<Way> ways;
    for (int number = 2; std::getline(in, line); ++number) {
        if (csv_trimmed(line).empty()) continue;
        const auto cells = csv_cells(line, ',');
        const auto value = [&](std::size_t at) {
            double result = 0.0;
            if (at >= cells.size() || !csv_number(cells[at], result) || !std::isfinite(result))
                throw InputError(file.string(), fmt::format("line {}", number), "is not a row of a track",
                                 "finite numbers and a robot");
            return result;
        };
        if (columns.robot >= cells.size())
            throw InputError(file.string(), fmt::format("line {}", number), "has no robot", "its name");
        const std::string name(cells[columns.robot]);
        const auto [place, fresh] = places.emplace(name, ways.size());
        if (fresh) ways.push_back({name, {}, {}, {}, {}});
        Way& way = ways[place->second];
        const double t = value(columns.t);
        if (!way.t.empty() && t <= way.t.back())
            throw InputError(file.string(), fmt::format("line {}", number),
                             fmt::format("the time of '{}' does not rise", name), "one row per frame");
        way.t.push_back(t);
        way.x.push_back(value(columns.x));
        way.y.push_back(value(columns.y));
        if (columns.has_heading) way.heading.push_back(value(columns.heading));
    }
    if (ways.empty()) throw InputError(file.string(), "", "has no rows", "the track of a run");
    return ways;
}

Behaviour behaviour_of(const std::vector<Way>& ways, const std::filesystem::path& file) {
    double begin = std::numeric_limits<double>::infinity(), end = -begin;
    for (const Way& way : ways) {
        begin = std::min(begin, way.t.front());
        end = std::max(end, way.t.back());
    }
    const double windows = std::floor((end - begin) / kWindow + 1e-9);
    if (!(windows >= static_cast<double>(kFewest)))
        throw InputError(file.string(), "", fmt::format("lasts {:.3g} s", end - begin),
                         fmt::format("at least {} s", kWindow * static_cast<double>(kFewest)));
    Mean speed, turning, standing, nearest, crowd, crossing;
    std::vector<double> straight, distances;
    Mean veer;
    Instant before = instant(ways, begin);
    for (double k = 1; k <= windows; ++k) {
        const Instant now = instant(ways, begin + k * kWindow);
        for (std::size_t i = 0; i < ways.size(); ++i) {
            if (!now.there[i]) continue;
            if (before.there[i]) {
                const double v = std::hypot(now.x[i] - before.x[i], now.y[i] - before.y[i]) / kWindow;
                speed.add(v);
                standing.add(v < kStanding ? 1.0 : 0.0);
                if (!ways[i].heading.empty()) {
                    const double turn =
                        std::remainder(now.heading[i] - before.heading[i], 2 * std::numbers::pi) / kWindow;
                    turning.add(std::abs(turn));
                    if (v >= kStanding && std::abs(turn) < kTurning) {
                        straight.push_back(v);
                        veer.add(turn);
                    }
                }
            }
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t j = 0; j < ways.size(); ++j)
                if (j != i && now.there[j])
                    least = std::min(least, std::hypot(now.x[i] - now.x[j], now.y[i] - now.y[j]));
            if (std::isfinite(least)) {
                nearest.add(least);
                distances.push_back(least);
            }
        }
        double x = 0, y = 0, x_before = 0, y_before = 0;
        if (middle(now, x, y)) {
            for (std::size_t i = 0; i < ways.size(); ++i)
                if (now.there[i]) crowd.add(std::hypot(now.x[i] - x, now.y[i] - y));
            if (middle(before, x_before, y_before))
                crossing.add(std::hypot(x - x_before, y - y_before) / kWindow);
        }
        before = now;
    }
    return {.speed = speed.value(),
            .turning = turning.value(),
            .standing = standing.value(),
            .nearest = nearest.value(),
            .crowd = crowd.value(),
            .cruise = median(straight),
            .veer = veer.value(),
            .approach = quantile(distances, kClosest),
            .crossing = crossing.value()};
}

}  // namespace puckloop::gap::mission
