// The way and the heading that the tracker saw, against those that the wheels were asked for: by a factor
// that no effect makes, a unit is wrong. What is refused (check_motion.cpp) lies further out still.

#include "gap/validate/checks.h"
#include "gap/validate/units.h"

#include "gap/stats/robust.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace puckloop::gap {

namespace {

constexpr double kFar = 4.0;          // factor
constexpr std::size_t kFewest = 8;    // stretches that say something
constexpr double kWay = 0.05;         // m that are asked: beyond a tracker's noise
constexpr double kLeastAsked = 1e-4;  // m: wheels that stand ask for nothing
constexpr double kMostTurned = 0.5;   // rad: beyond, a marker off the axle moves by itself
constexpr double kAlongAxis = 0.5;    // share of a stretch's way that lies along x or y

/// What was seen over what was asked, of each stretch.
struct Ratios {
    std::vector<double> way, x, y, heading;
};

/// A stretch begins at `first`; the wheels' own pose since then, in the room as the heading stood.
struct Asked {
    std::size_t first = 0;
    double x = 0, y = 0, turned = 0;
};

void take(const Run& run, const Asked& asked, std::size_t last, Ratios& ratios) {
    const double wanted = std::hypot(asked.x, asked.y);
    if (wanted < kLeastAsked || std::abs(asked.turned) > kMostTurned) return;
    const auto seen = [&](const char* column) {
        return run.column(column)[last] - run.column(column)[asked.first];
    };
    const double dx = seen("x_m"), dy = seen("y_m");
    ratios.way.push_back(std::hypot(dx, dy) / wanted);
    if (std::abs(asked.x) > kAlongAxis * wanted) ratios.x.push_back(std::abs(dx / asked.x));
    if (std::abs(asked.y) > kAlongAxis * wanted) ratios.y.push_back(std::abs(dy / asked.y));
}

void measure(const Experiment& experiment, const Run& run, Ratios& ratios) {
    constexpr double kLeastTurn = 0.1;  // rad
    const double metre = metres_per_step(experiment),
                 axle = experiment.nominal_or("robot.axle_length", physics::kAxleLength);
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    Asked asked;
    double turned = 0;
    std::size_t from = 0;
    for (std::size_t i = 1; i < run.rows; ++i) {
        const auto [left, right] = steps_made(run, i);
        const double way = (left + right) / 2 * metre, turn = (right - left) * metre / axle,
                     middle = theta[asked.first] + asked.turned + turn / 2;
        asked.x += way * std::cos(middle), asked.y += way * std::sin(middle), asked.turned += turn;
        turned += turn;
        const bool known = std::isfinite(asked.x + turned + x[i] + y[i] + theta[i]);
        // By what was asked: a stretch that ended where the tracker errs would have its error as its way.
        const bool far = std::hypot(asked.x, asked.y) >= kWay;
        if (known && far) take(run, asked, i, ratios);
        if (!known || far || std::abs(asked.turned) > kMostTurned) asked = {i};
        if (known && std::abs(turned) >= kLeastTurn)
            ratios.heading.push_back(
                std::abs(std::remainder(theta[i] - theta[from], 2 * std::numbers::pi) / turned));
        if (!known || std::abs(turned) >= kLeastTurn) turned = 0, from = i;
    }
}

/// NaN where there are few.
double middle_of(const std::vector<double>& ratios) {
    return ratios.size() < kFewest ? NAN : stats::upper_median(ratios);
}
bool far_off(double ratio) {
    return ratio > kFar || ratio < 1 / kFar;
}

/// What to do about columns that come out `ratio` times what is expected.
std::string advice(const Experiment& experiment, const std::vector<std::string_view>& columns, double ratio) {
    const ColumnInfo& info = *find_column(experiment.kind, columns.front());
    const std::string_view unit = likely_unit(experiment, info, ratio, 1.0);
    if (unit.empty()) return fmt::format("is the unit of {} right?", fmt::join(columns, " and "));
    return to_state(experiment, columns, unit);
}

}  // namespace

void check_motion_units(Experiment& experiment) {
    Ratios ratios;
    bool counted = false;
    for (const Run& run : experiment.runs) {
        measure(experiment, run, ratios);
        counted = counted || run.has("steps_left");
    }
    const char* wheels = counted ? "the wheels did" : "the commands over t_s ask for";
    const double way = middle_of(ratios.way), x = middle_of(ratios.x), y = middle_of(ratios.y),
                 heading = middle_of(ratios.heading);
    std::vector<std::string_view> columns;
    // Of an axis along which the robot hardly drove the other one speaks too.
    if (far_off(std::isnan(x) ? y : x)) columns.emplace_back("x_m");
    if (far_off(std::isnan(y) ? x : y)) columns.emplace_back("y_m");
    if (columns.empty() && far_off(way)) columns = {"x_m", "y_m"};
    if (!columns.empty()) {
        const double seen = columns.size() == 2 && far_off(way) ? way : far_off(x) ? x : y;
        experiment.caution("{}: by {} the robot went {:.3g} times as far as {}: {}{}",
                           files_with(experiment, "x_m"), fmt::join(columns, " and "), seen, wheels,
                           advice(experiment, columns, seen),
                           counted ? "" : " (or are cmd_left, cmd_right not in steps/s?)");
    }
    if (far_off(heading))
        experiment.caution("{}: theta_rad turns {:.3g} times as far as {}: {}",
                           files_with(experiment, "theta_rad"), heading, wheels,
                           advice(experiment, {"theta_rad"}, heading));
}

}  // namespace puckloop::gap
