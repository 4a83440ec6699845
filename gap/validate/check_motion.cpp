#include "gap/validate/checks.h"

#include "gap/stats/robust.h"
#include "gap/validate/units.h"
#include "physics/description/robot_constants.h"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kFastestWheel = 5.0;       // m/s
constexpr double kFactor = 5.0;             // between what two columns say of one thing
constexpr double kWay = 0.05, kTurn = 0.5;  // m, rad: beyond a tracker's noise; what a marker's swing adds
constexpr double kClear = 0.5;              // correlation of columns that go together
constexpr double kSameWay = 0.9;            // share of the turns by wheels in which the heading goes along
constexpr double kSideways = 0.6;           // share of a straight step that must lie along the heading

struct Path {
    double length = 0.0;  // tracked
    double duration = 0.0, largest_turn = 0.0;
};

Path measure(const Run& run) {
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    const auto& time = run.column("t_s");
    Path path;
    std::size_t last = run.rows;
    for (std::size_t i = 0; i < run.rows; ++i) {
        if (std::isnan(x[i]) || std::isnan(y[i]) || std::isnan(theta[i])) continue;
        if (last < run.rows) {
            const double turn = std::remainder(theta[i] - theta[last], 2 * std::numbers::pi);
            path.length += std::hypot(x[i] - x[last], y[i] - y[last]);
            path.largest_turn = std::max(path.largest_turn, std::abs(turn));
            path.duration += time[i] - time[last];
        }
        last = i;
    }
    return path;
}

/// What a counter did from one row to the next that has it.
struct Counted {
    std::size_t last, row;
    double from, to, span;  // steps, steps, s
    double far() const { return std::abs(to - from); }
};

std::vector<Counted> counted_rows(const Run& run, const char* name) {
    const auto &steps = run.column(name), &time = run.column("t_s");
    std::vector<Counted> rows;
    std::size_t last = run.rows;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (std::isnan(steps[i] + time[i])) continue;
        if (last < run.rows)
            rows.push_back({last, i, steps[last], steps[i], std::max(time[i] - time[last], 1e-3)});
        last = i;
    }
    return rows;
}

/// A counter that wrapped, was reset, or has another unit. Reset is one that is where it would be had it
/// begun at 0 in this row, and came there twice as fast as it went in any other row, and than the tracker saw
/// its wheel go.
void check_counter(const Experiment& experiment, const Run& run, const char* name) {
    constexpr double kWrap = 65536, kTwice = 2.0;
    constexpr double kAgrees = std::numbers::pi / 8;  // rad; by chance one in eight does
    const double metre = metres_per_step(experiment),
                 axle = experiment.nominal_or("robot.axle_length", physics::kAxleLength);
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    const bool left = std::string_view(name) == "steps_left";
    const auto& other = run.column(left ? "steps_right" : "steps_left");
    const double sense = left ? 1.0 : -1.0;  // in which this wheel's way is taken from the other's
    const std::vector<Counted> rows = counted_rows(run, name);
    double fastest = 0.0;  // steps/s, of rows that leave most of the count
    const auto too_far = [&](const Counted& one) {
        return one.far() * metre >= kFastestWheel * std::max(one.span, 0.1);
    };
    for (const Counted& one : rows)
        if (std::abs(one.to) >= std::abs(one.from) / 2 && !too_far(one))
            fastest = std::max(fastest, one.far() / one.span);
    for (const auto& one : rows) {
        const auto& [last, row, from, to, span] = one;
        // Whole turns may have passed unseen: where the heading agrees with both counters, they did.
        const double turn = (other[row] - other[last] - (to - from)) * sense * metre / axle,
                     change = theta[row] - theta[last],
                     turned = std::abs(std::remainder(change - turn, 2 * std::numbers::pi)) < kAgrees
                                  ? turn
                                  : std::remainder(change, 2 * std::numbers::pi),
                     seen = std::hypot(x[row] - x[last], y[row] - y[last]) + std::abs(turned) * axle / 2;
        const double usual = fastest * span + 1, far = one.far();  // whole steps
        const bool reset = std::abs(to) <= usual && far > kTwice * usual && kTwice * seen <= far * metre;
        if (!reset && !too_far(one)) continue;
        const bool wrapped = std::abs(far - kWrap) <= usual;
        refuse(experiment, run,
               fmt::format("{} jumps by {:.6g} steps in {:.3g} s{}", name, to - from, span,
                           wrapped ? ": a 16-bit counter that wrapped"
                           : reset ? ": a counter that was reset, as where a robot starts anew"
                                   : ""),
               wrapped ? "counters put together over wraps (add 65536)"
               : reset ? "what it counted before added from here on, or another run"
                       : "a counter that runs on",
               static_cast<long>(row));
    }
}

/// Does the tracker see the robot go somewhere?
bool moves(const Run& run) {
    stats::Range x, y;
    x.take(run.column("x_m")), y.take(run.column("y_m"));
    return std::hypot(x.high - x.low, y.high - y.low) > kWay;
}

/// Counters beside commands: each wheel's counter must follow its own command. All steps go to `all`.
void check_commands(const Experiment& experiment, const Run& run, Pairs& all) {
    if (!run.has("steps_left") || !run.has("cmd_left")) return;
    const auto &time = run.column("t_s"), &left = run.column("steps_left"),
               &right = run.column("steps_right"), &cmd_left = run.column("cmd_left"),
               &cmd_right = run.column("cmd_right");
    double own = 0.0, crossed = 0.0;
    Eigen::Array2d ran(0, 0), commanded(0, 0), along(0, 0);  // of left and right wheel
    const std::vector<double> spans = stats::steps_of(time);
    if (spans.empty()) return;
    const double longest = 10 * stats::upper_median(spans);  // beyond is a gap in the record
    for (std::size_t i = 1; i < run.rows; ++i) {
        const double span = time[i] - time[i - 1];
        const Eigen::Array2d steps(left[i] - left[i - 1], right[i] - right[i - 1]),
            wanted(cmd_left[i - 1] * span, cmd_right[i - 1] * span);
        if ((steps + wanted).hasNaN() || span > longest) continue;
        own += (steps - wanted).abs().sum();
        crossed += (steps - wanted.reverse()).abs().sum();
        ran += steps.abs();
        commanded += wanted.abs();
        for (const int w : {0, 1})
            along[w] += std::copysign(steps[w], steps[w] * wanted[w]), all.add_both(wanted[w], steps[w]);
    }
    constexpr double kEnough = 500;  // steps asked for
    constexpr const char* kSide[] = {"left", "right"};
    for (const int w : {0, 1})
        if (commanded[w] > kEnough && ran[w] == 0 && moves(run))
            refuse(experiment, run,
                   fmt::format("steps_{} stands still while its wheel is commanded", kSide[w]),
                   "a counter that counts");
    for (const int w : {0, 1})
        if (commanded[w] > kEnough && along[w] < -ran[w] / 2)
            refuse(experiment, run,
                   fmt::format("steps_{0} runs against cmd_{0}: one of them has the wrong sign", kSide[w]),
                   "forward positive in both");
    if (commanded.sum() > kEnough && crossed < 0.3 * own)
        refuse(experiment, run,
               "steps_left follows cmd_right and steps_right cmd_left: left and right are swapped in one",
               "a wheel's counter beside its command");
}

/// Turns by the wheels, and of the heading.
void add_turns(const Experiment& experiment, const Run& run, Pairs& turns) {
    constexpr double kLeastWay = 0.002, kLeastTurn = 0.02;  // m, rad
    const auto& theta = run.column("theta_rad");
    double turned = 0.0, seen = 0.0;
    for (const Stretch& one : stretches_of(experiment, run, kLeastWay, kLeastTurn)) {
        turned += one.turned;
        seen += theta[one.last] - theta[one.first];
        if (std::abs(turned) < kLeastTurn || seen == 0.0) continue;  // or a step of the heading is to come
        turns.add(turned, seen);
        turned = seen = 0.0;
    }
}

/// Against what the wheels make of it: a degree for a radian is 57, a turn 0.16.
void check_heading(const Experiment& experiment, const Run& run, double times, bool counted) {
    constexpr double kDegrees = 10.0, kLeastTurned = 0.25;
    if (!(times > kDegrees || (counted && times < kLeastTurned))) return;  // commands may move nothing
    refuse(experiment, run,
           fmt::format("theta_rad turns {:.3g} times as far as the wheels do: {}", times,
                       times > kDegrees ? "degrees?" : "wrong unit, or not the heading"),
           "radians; \"deg\" and \"turn\" are known in [columns]");
}

/// Where the tracker saw the robot go while its wheels went straight.
void check_direction(const Experiment& experiment, const Run& run) {
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    double along = 0.0, all = 0.0;
    for (const Stretch& one : stretches_of(experiment, run, kWay, kTurn)) {
        const double dx = x[one.last] - x[one.first], dy = y[one.last] - y[one.first],
                     turn = theta[one.last] - theta[one.first], step = std::hypot(dx, dy),
                     way = std::abs(one.way);
        if (way < kWay || step <= way / 2 || step >= 2 * way) continue;
        const double middle = theta[one.first] + std::remainder(turn, 2 * std::numbers::pi) / 2;
        along += std::copysign(1.0, one.way) * (dx * std::cos(middle) + dy * std::sin(middle));
        all += step;
    }
    constexpr double kEnough = 0.1;  // m
    if (all > kEnough && along < -kSideways * all)
        refuse(experiment, run,
               "the robot drives backwards where its wheels turn forwards: theta_rad points to the rear",
               "the heading's direction");
    if (all > kEnough && along < kSideways * all)
        refuse(experiment, run,
               fmt::format("only {:.0f} % of the way lies along theta_rad: x_m and y_m are swapped, or "
                           "theta_rad is not the heading",
                           100 * std::max(along, 0.0) / all),
               "x, y and a counter-clockwise heading from the x axis");
}

/// Without counters nothing is known of commands in a hole of the record.
void check_holes(Experiment& experiment, const Run& run) {
    constexpr double kHole = 10.0;  // usual steps
    if (run.has("steps_left")) return;
    const auto& time = run.column("t_s");
    const std::vector<double> spans = stats::steps_of(time);
    if (spans.empty()) return;
    const double longest = kHole * stats::upper_median(spans);
    for (std::size_t i = 1; i < run.rows; ++i)
        if (time[i] - time[i - 1] > longest)
            experiment.caution(
                "{}: no rows for {:.3g} s before row {}: the commands given meanwhile are not known, and "
                "the last one is taken to have stood (commands that get lost look the same)",
                run.file, time[i] - time[i - 1], i + 1);
}

/// What commands are in, and what that is on the floor.
std::string steps_a_second(const Experiment& experiment) {
    return fmt::format("steps/s (a step is {:.3g} mm)", 1000 * metres_per_step(experiment));
}

/// The way that the tracker saw, and the heading, against those that the wheels made or were asked for. A
/// robot that is held goes together with neither.
void check_way(Experiment& experiment, bool counted, const Pairs& turns) {
    constexpr double kAsked = 20;  // wheels need not do what they are asked for
    constexpr std::size_t kEnough = 5;
    Pairs x, y, both;
    std::vector<std::string> held;
    std::size_t driven = 0;
    for (const Run& run : experiment.runs) {
        std::vector<double> gone;
        for (const Stretch& one : stretches_of(experiment, run, kWay, kTurn, kWay)) {
            const auto moved = [&](const char* column) {
                return run.column(column)[one.last] - run.column(column)[one.first];
            };
            const double turned = std::remainder(moved("theta_rad"), 2 * std::numbers::pi),
                         middle = run.column("theta_rad")[one.first] + turned / 2,
                         ahead = one.way * std::cos(middle), aside = one.way * std::sin(middle);
            x.add_both(ahead, moved("x_m")), both.add_both(ahead, moved("x_m"));
            y.add_both(aside, moved("y_m")), both.add_both(aside, moved("y_m"));
            if (std::abs(one.way) >= kWay)
                gone.push_back(std::hypot(moved("x_m"), moved("y_m")) / std::abs(one.way));
        }
        if (!run.has("steps_left") || gone.size() < kEnough) continue;
        driven += 1;
        if (stats::median(gone) < 1 / kFar) held.push_back(run.file);
    }
    const double factor = both.factor(kClear), most = counted ? kFactor : kAsked;
    const std::string far = fmt::format("the robot went {:.3g} times as far as {}", factor,
                                        counted ? "its wheels turned" : "the commands over t_s ask for");
    if (factor > most || factor < 1 / most)
        refuse(experiment, experiment.runs.front(),
               far + (counted ? ": wrong unit of x_m, y_m or a wrong robot.wheel_radius / steps_per_turn in "
                                "[nominal]"
                              : ": wrong unit of t_s, of x_m and y_m or of cmd_left, cmd_right"),
               counted ? "the same within a factor of five"
                       : "seconds, metres and " + steps_a_second(experiment));
    const std::string stands =
        fmt::format("the tracker mostly sees the robot stand while its wheels turn, in {} of {} runs ({}): "
                    "held fast, off the floor, stalled, or another thing is tracked",
                    held.size(), driven, held.empty() ? "" : held.front());
    if (driven > 0 && held.size() == driven) refuse(experiment, stands, "runs in which the robot drives");
    if (!held.empty()) experiment.cautions.push_back(stands);
    const std::size_t before = experiment.cautions.size();
    const char* other = counted ? "what the wheels did" : "cmd_left, cmd_right over t_s";
    ask_factor(experiment, {{"x_m"}}, other, x.factor());
    ask_factor(experiment, {{"y_m"}}, other, y.factor());
    if (!counted && factor > kFar && experiment.cautions.size() == before)
        experiment.caution("{}: are cmd_left, cmd_right in {}?", far, steps_a_second(experiment));
    if (!(factor < 1 / kFar))  // else it is held
        ask_factor(experiment, {{"theta_rad"}}, other, std::abs(turns.ratio()));
}

}  // namespace

double metres_per_step(const Experiment& experiment) {
    return 2 * std::numbers::pi * experiment.nominal_or("robot.wheel_radius_left", physics::kWheelRadius) /
           experiment.nominal_or("robot.steps_per_turn", physics::kStepsPerTurn);
}

std::array<double, 2> steps_made(const Run& run, std::size_t row) {
    const bool counted = run.has("steps_left");
    const auto &left = run.column(counted ? "steps_left" : "cmd_left"),
               &right = run.column(counted ? "steps_right" : "cmd_right"), &time = run.column("t_s");
    if (counted) return {left[row] - left[row - 1], right[row] - right[row - 1]};
    const double span = time[row] - time[row - 1];
    return {left[row - 1] * span, right[row - 1] * span};
}

std::vector<Stretch> stretches_of(const Experiment& experiment, const Run& run, double least_way,
                                  double least_turn, double least_tracked) {
    const double metre = metres_per_step(experiment),
                 axle = experiment.nominal_or("robot.axle_length", physics::kAxleLength);
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    std::vector<Stretch> all;
    Stretch one{0, 0, 0.0, 0.0};
    for (std::size_t i = 1; i < run.rows; ++i) {
        const auto [left, right] = steps_made(run, i);
        one.last = i;
        one.way += (left + right) / 2 * metre;
        one.turned += (right - left) * metre / axle;
        const bool known =
            std::isfinite(one.way + x[i] + y[i] + theta[i] + x[one.first] + y[one.first] + theta[one.first]);
        if (known && std::abs(one.way) < least_way && std::abs(one.turned) < least_turn &&
            std::hypot(x[i] - x[one.first], y[i] - y[one.first]) < least_tracked)
            continue;
        if (known) all.push_back(one);
        one = {i, i, 0.0, 0.0};
    }
    return all;
}

/// Left and right wheel exchanged turn the other way; millimetres taken for metres go a thousand times too
/// far.
void check_motion(Experiment& experiment) {
    double tracked = 0.0, duration = 0.0;
    bool steps = false, heading_fixed = true;
    Pairs counted, turns;
    for (const Run& run : experiment.runs) {
        const Path path = measure(run);
        tracked += path.length;
        heading_fixed = heading_fixed && path.largest_turn == 0.0;
        duration += path.duration;
        if (run.has("steps_left") != run.has("steps_right") || run.has("cmd_left") != run.has("cmd_right"))
            refuse(experiment, run, "has one wheel's column without the other's", "both");
        if (!run.has("steps_left") && !run.has("cmd_left"))
            refuse(experiment, run, "has neither steps_left, steps_right nor cmd_left, cmd_right",
                   "what the wheels did or were told");
        if (run.has("steps_left"))
            for (const char* counter : {"steps_left", "steps_right"})
                check_counter(experiment, run, counter);
        add_turns(experiment, run, turns);
        check_commands(experiment, run, counted);
        check_holes(experiment, run);
        if (path.largest_turn > 2.5)
            experiment.caution(
                "{}: theta_rad jumps by {:.2f} rad between two rows: too sparse, or a wrong unit", run.file,
                path.largest_turn);
        steps = steps || run.has("steps_left");
    }
    const Run& first = experiment.runs.front();
    if (tracked == 0.0 && heading_fixed)
        refuse(experiment, first, "the pose is the same in every row",
               "what the tracker saw of a robot that moves");
    if (const double factor = counted.factor(kClear); factor > kFactor || factor < 1 / kFactor)
        refuse(
            experiment, first,
            fmt::format("the counters ran {:.3g} times as many steps as the commands over t_s ask for: wrong "
                        "unit of t_s or cmd_left, cmd_right",
                        factor),
            "seconds and " + steps_a_second(experiment));
    const double times = turns.ratio();
    check_way(experiment, steps, turns);
    check_heading(experiment, first, std::abs(times), false);
    if (times < 0)
        refuse(experiment, first,
               "the robot turns the other way than its wheels: left and right are swapped, or theta_rad runs "
               "clockwise",
               "the right wheel faster for a counter-clockwise turn");
    if (duration > 0 && tracked / duration > 3.0)
        refuse(experiment, first,
               fmt::format("the robot moves {:.3g} m/s on average: wrong unit of x_m, y_m or t_s",
                           tracked / duration),
               "at most 3 m/s");
    for (const Run& run : experiment.runs)
        if (run.has("steps_left")) {
            Pairs of_run;
            add_turns(experiment, run, of_run);
            // Counters that err turn the robot by their errors: no unit. A heading that was scaled with its
            // wraps hardly correlates, but turns the way the wheels do.
            const bool together = !std::isnan(of_run.factor(kClear)) || of_run.agreement() > kSameWay;
            check_heading(experiment, run, std::abs(of_run.ratio()), together);
            check_direction(experiment, run);
        }
    check_carried(experiment);
}

}  // namespace puckloop::gap
