#include "tools/gap/emulate/reacts.h"

#include "physics/description/parameters.h"
#include "tools/gap/emulate/plans.h"
#include "tools/gap/emulate/reacts_sensors.h"
#include "tools/gap/emulate/surroundings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <tuple>

namespace puckloop::gap::emulate {

namespace {

constexpr double kStanding = 1.0;        // s of an act without a motion of its own, at least
constexpr double kAround = 0.5;          // s: readings as near as this to a row's time are its mean
constexpr double kSettled = 0.45;        // s after which readings count
constexpr double kSmallestArena = 6.0;   // m
constexpr double kMargin = 1.0;          // m between the measured path and a wall
constexpr std::size_t kPlacements = 24;  // of a proximity experiment
constexpr double kClear = 0.0005;        // m between body and wall
constexpr double kFine = 1e-5;           // m and rad: closer placements are one

double median_step(const std::vector<double>& times) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i)
        if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
    if (steps.empty()) return 0.0;
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    return steps[steps.size() / 2];
}

std::string open_floor(double reach) {
    const double size = std::max(kSmallestArena, 2 * (reach + kMargin));
    return fmt::format("[arena]\nsize = [\"{0:.3f} m\", \"{0:.3f} m\"]\n", size);
}

/// Before the first movement the pose is the mean of what the tracker saw.
void starting_pose(const Run& run, React& react) {
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    double count = 0, turn = 0, first = NAN;
    for (std::size_t i = 0; i < run.rows; ++i) {
        const bool stands =
            count == 0 || (run.column("cmd_left")[i - 1] == 0.0 && run.column("cmd_right")[i - 1] == 0.0);
        if (!stands) break;
        if (std::isnan(x[i]) || std::isnan(y[i]) || std::isnan(theta[i])) continue;
        if (count == 0) first = theta[i];
        react.x += x[i];
        react.y += y[i];
        turn += std::remainder(theta[i] - first, 2 * std::numbers::pi);
        ++count;
    }
    react.x /= count;
    react.y /= count;
    react.heading = first + turn / count;
}

std::vector<React> motion(const Experiment& experiment, std::string& why) {
    std::vector<React> reacts;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        const Run& run = experiment.runs[r];
        const auto &t = run.column("t_s"), &left = run.column("cmd_left"), &right = run.column("cmd_right");
        if (left.empty() || right.empty() || run.rows < 3) continue;
        React react;
        react.run = r;
        react.period = median_step(t);
        starting_pose(run, react);
        react.act.heading = react.heading;
        double reach = 0.0;
        for (std::size_t i = 0; i < run.rows; ++i) {
            const double x = run.column("x_m")[i] - react.x, y = run.column("y_m")[i] - react.y;
            if (!std::isnan(x) && !std::isnan(y)) reach = std::max(reach, std::hypot(x, y));
            if (std::isnan(left[i]) || std::isnan(right[i]) || std::isnan(t[i])) continue;
            auto& commands = react.act.commands;
            if (commands.empty() || commands.back().left != left[i] || commands.back().right != right[i])
                commands.push_back({t[i] - t[0], left[i], right[i]});
            react.rows.push_back(i);
        }
        if (react.rows.empty() || !(react.period > 0) || std::isnan(react.x)) continue;
        react.act.commands.push_back({t.back() - t[0], left.back(), right.back()});
        react.act.arena = open_floor(reach);
        restore_surroundings(run, react.act);
        reacts.push_back(std::move(react));
    }
    if (reacts.empty()) why = "no run with wheel commands beside its path";
    return reacts;
}

/// Exchanges from one reading over I2C to the next, if the run keeps to it from the first on; 0: none, or no
/// such order.
int reads_every(const Run& run) {
    const auto& reads = run.column("i2c_reads");
    std::size_t second = 1;
    while (second < reads.size() && reads[second] == 0.0)
        ++second;
    for (std::size_t i = 0; i < reads.size(); ++i)
        if ((reads[i] > 0) != (i % second == 0)) return 0;
    return reads.empty() ? 0 : static_cast<int>(second);
}

std::vector<React> timing(const Experiment& experiment, std::string& why) {
    constexpr double kLeastPeriod = 0.01;  // s: an exchange takes 8 ms on the line
    std::vector<React> reacts;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        const Run& run = experiment.runs[r];
        const double period = value_of(run, "nominal_period", 0, 0.1);
        if (run.rows < 3 || !(period >= kLeastPeriod)) continue;
        React react;
        react.run = r;
        react.period = period;
        double last = 0.0;
        for (std::size_t i = 0; i < run.rows; ++i) {
            react.rows.push_back(i);
            last = std::max(last, value_of(run, "seq", i, static_cast<double>(i)));
        }
        react.act.arena = open_floor(0);
        react.act.relative = true;
        react.act.ground = reads_every(run) > 0;
        react.act.ground_every = std::max(reads_every(run), 1);
        react.act.commands = {{0, 0, 0}, {last * period, 0, 0}};
        reacts.push_back(std::move(react));
    }
    // The recording's own exchange is 84 bytes long and as fast as its firmware answers.
    if (reacts.empty()) why = "no run with three frames, 10 ms or more apart";
    return reacts;
}

/// The robot stands until the row was measured, as far as `longest` lets it.
void stand(const Run& run, std::size_t row, double longest, Act& act) {
    const double t = value_of(run, "t_s", row, 0.0);
    const double until = std::clamp(std::isnan(t) ? 0.0 : t, kStanding, std::max(longest, kStanding));
    const double so_far = act.commands.empty() ? 0.0 : act.commands.back().seconds;
    act.commands = {{0, 0, 0}, {std::max(until, so_far), 0, 0}};
}

std::vector<React> ground(const Experiment& experiment, double longest, std::string& why) {
    std::map<double, React> by_grey;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        const Run& run = experiment.runs[r];
        for (std::size_t i = 0; i < run.rows; ++i) {
            const double grey = value_of(run, "grey", i, NAN);
            const double slope =
                std::abs(value_of(run, "grey_rate", i, 0)) + std::abs(value_of(run, "grey_across", i, 0)) +
                std::abs(value_of(run, "pitch_rad", i, 0)) + std::abs(value_of(run, "acceleration", i, 0));
            if (!(grey >= 0 && grey <= 1) || slope != 0.0) continue;
            React& react = by_grey[grey];
            react.act.ground = true;
            react.act.arena = fmt::format(
                "[arena]\nsize = [\"2 m\", \"2 m\"]\n[[floor_patch]]\ncentre = [\"0 m\", \"0 m\"]\n"
                "size = [\"1.8 m\", \"1.8 m\"]\ngrey = {:.9g}\n",
                grey);
            stand(run, i, longest, react.act);
            react.rows.push_back(r);
            react.rows.push_back(i);  // rows of all runs: pairs of run and row
        }
    }
    std::vector<React> reacts;
    for (auto& [grey, react] : by_grey)
        if (reacts.size() < kPlacements) reacts.push_back(std::move(react));
    if (reacts.empty()) why = "no row on an even grey";
    return reacts;
}

/// A robot that stands with one sensor before a wall, at the row's distance and angle.
bool stand_before_wall(const Run& run, std::size_t row, React& react) {
    const physics::Parameters nominal;
    const double sensor = value_of(run, "sensor", row, 0), distance = value_of(run, "distance_m", row, NAN),
                 angle = value_of(run, "angle_rad", row, 0);
    if (!(sensor >= 0 && sensor < physics::kProximitySensors) || !(distance > 0) || std::isnan(angle) ||
        std::isnan(value_of(run, "reading", row, NAN)))
        return false;
    // A robot that stands says nothing of one that drives.
    if (value_of(run, "velocity", row, 0) != 0.0 || value_of(run, "motor_speed", row, 0) != 0.0) return false;
    const auto s = static_cast<std::size_t>(sensor);
    const auto& ring = nominal.proximity;
    react.sensor = s;
    react.act.heading = std::remainder(-angle - ring.direction[s], 2 * std::numbers::pi);
    const double c = std::cos(react.act.heading), n = std::sin(react.act.heading);
    react.act.x = kWallFace - distance * std::cos(angle) - (c * ring.x[s] - n * ring.y[s]);
    if (kWallFace - react.act.x < nominal.robot.radius + kClear) return false;
    react.act.arena = fmt::format("[arena]\nsize = [\"4 m\", \"4 m\"]\n[light]\nambient = "
                                  "{:.9g}\n[[box]]\ncentre = [\"{} m\", \"0 m\"]\n"
                                  "size = [\"10 cm\", \"120 cm\", \"12 cm\"]\nreflectivity = {:.9g}\n",
                                  std::clamp(value_of(run, "ambient", row, 0), 0.0, 1.0), kWallFace + 0.05,
                                  std::max(value_of(run, "reflectivity", row, 1), 0.0));
    return true;
}

std::vector<React> proximity(const Experiment& experiment, double longest, std::string& why) {
    if (experiment.has("off_axis_rad")) {
        why = "objects narrower than a wall are not put up again";
        return {};
    }
    // One a placement; of many every so-many-th, in order of sensor and distance.
    std::map<std::tuple<long, long, long, long, long>, React> placements;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r)
        for (std::size_t i = 0; i < experiment.runs[r].rows; ++i) {
            const Run& run = experiment.runs[r];
            React react;
            react.run = r;
            if (!stand_before_wall(run, i, react)) continue;
            const auto whole = [&](const char* name, double fallback) {
                return std::lround(value_of(run, name, i, fallback) / kFine);
            };
            React& place =
                placements
                    .try_emplace({static_cast<long>(react.sensor), whole("distance_m", 0),
                                  whole("angle_rad", 0), whole("ambient", 0), whole("reflectivity", 1)},
                                 react)
                    .first->second;
            stand(run, i, longest, place.act);
            place.rows.push_back(r);
            place.rows.push_back(i);
        }
    std::vector<React> all;
    for (auto& [place, react] : placements)
        all.push_back(std::move(react));
    if (all.empty()) why = "no row with a sensor before a wall that the body does not touch";
    return spread_of(all, kPlacements);
}

void motion_errors(const Run& run, const React& react, const std::vector<Row>& emulated,
                   std::vector<ErrorSum>& errors) {
    std::size_t place = 0;
    const auto& t = run.column("t_s");
    for (const std::size_t row : react.rows) {
        const double now = t[row] - t[0];
        while (place + 2 < emulated.size() && emulated[place + 1].t < now)
            ++place;
        const Row &a = emulated[place], &b = emulated[std::min(place + 1, emulated.size() - 1)];
        const double f = b.t > a.t ? std::clamp((now - a.t) / (b.t - a.t), 0.0, 1.0) : 0.0;
        const double dx = run.column("x_m")[row] - react.x - (a.x + f * (b.x - a.x)),
                     dy = run.column("y_m")[row] - react.y - (a.y + f * (b.y - a.y));
        add(errors[0], std::hypot(dx, dy));
        const double heading = a.theta + f * std::remainder(b.theta - a.theta, 2 * std::numbers::pi);
        add(errors[1], std::remainder(run.column("theta_rad")[row] - heading, 2 * std::numbers::pi));
    }
}

/// Arrivals about their mean; the clocks' zeros are not known.
void timing_errors(const Run& run, const React& react, const std::vector<Row>& emulated,
                   std::vector<ErrorSum>& errors) {
    std::vector<double> left;
    double mean = 0.0, broken_measured = 0.0, broken = 0.0, judged = 0.0;
    for (const std::size_t row : react.rows) {
        const auto seq = static_cast<std::size_t>(value_of(run, "seq", row, static_cast<double>(row)));
        if (seq >= emulated.size()) continue;
        const double ok = value_of(run, "frame_ok", row, NAN);
        if (!std::isnan(ok)) {
            broken_measured += ok < 0.5 ? 1 : 0;
            broken += emulated[seq].ok ? 0 : 1;
            ++judged;
        }
        if (ok < 0.5 || !emulated[seq].ok) continue;
        left.push_back(run.column("t_host_s")[row] - emulated[seq].answered);
        if (std::isnan(left.back()))
            left.pop_back();
        else
            mean += left.back();
    }
    for (const double one : left)
        add(errors[0], one - mean / static_cast<double>(left.size()));
    if (judged > 0) add(errors[1], (broken_measured - broken) / judged);
}

/// Mean about the time `t`, or the nearest to it at which the robot stood.
double standing_mean(const std::vector<Row>& emulated, double t,
                     const std::function<double(const Row&)>& value) {
    const double about = std::clamp(std::isnan(t) ? 0.0 : t, kSettled, emulated.back().t);
    double sum = 0.0, count = 0.0;
    for (const Row& row : emulated) {
        const double one = value(row);
        if (row.t < kSettled || std::abs(row.t - about) > kAround || !row.ok || std::isnan(one)) continue;
        sum += one;
        ++count;
    }
    return sum / count;
}

}  // namespace

std::vector<React> spread_of(const std::vector<React>& all, std::size_t most) {
    std::vector<React> some;
    const std::size_t count = std::min(all.size(), most);
    for (std::size_t k = 0; k < count; ++k)
        some.push_back(all[k * all.size() / count]);
    return some;
}

double value_of(const Run& run, std::string_view name, std::size_t row, double fallback) {
    const auto& column = run.column(name);
    return column.empty() ? fallback : column[row];
}

void add(ErrorSum& sum, double error) {
    if (std::isnan(error)) return;
    sum.squares += error * error;
    ++sum.rows;
}

std::vector<React> reacts_of(const Experiment& experiment, double longest, std::string& why) {
    switch (experiment.kind) {
    case Kind::Motion:
        return motion(experiment, why);
    case Kind::Timing:
        return timing(experiment, why);
    case Kind::Ground:
        return ground(experiment, longest, why);
    case Kind::Proximity:
        return proximity(experiment, longest, why);
    case Kind::Microphone:
        return microphone_reacts(experiment, why);
    case Kind::Accelerometer:
        return accelerometer_reacts(experiment, why);
    default:
        why = fmt::format("experiments of kind {} are not performed again", kind_name(experiment.kind));
        return {};
    }
}

std::vector<std::pair<const char*, const char*>> compared(Kind kind) {
    switch (kind) {
    case Kind::Motion:
        return {{"position", "m"}, {"heading", "rad"}};
    case Kind::Timing:
        return {{"arrival", "s"}, {"broken frames", "1"}};
    case Kind::Microphone:
        return {{"level", "counts"}};
    case Kind::Accelerometer:
        return {{"ax", "counts"}, {"ay", "counts"}, {"az", "counts"}};
    default:
        return {{"reading", "counts"}};
    }
}

void add_errors(const Experiment& experiment, const React& react, const std::vector<Row>& emulated,
                std::vector<ErrorSum>& errors) {
    if (experiment.kind == Kind::Motion)
        return motion_errors(experiment.runs[react.run], react, emulated, errors);
    if (experiment.kind == Kind::Timing)
        return timing_errors(experiment.runs[react.run], react, emulated, errors);
    if (experiment.kind == Kind::Microphone) return microphone_errors(experiment, react, emulated, errors);
    if (experiment.kind == Kind::Accelerometer)
        return accelerometer_errors(experiment, react, emulated, errors);
    for (std::size_t k = 0; k + 1 < react.rows.size(); k += 2) {
        const Run& run = experiment.runs[react.rows[k]];
        const std::size_t row = react.rows[k + 1];
        const bool floor = experiment.kind == Kind::Ground;
        const auto sensor = floor ? static_cast<std::size_t>(value_of(run, "sensor", row, 0)) : react.sensor;
        const double told = standing_mean(emulated, value_of(run, "t_s", row, 0.0), [&](const Row& r) {
            return floor ? r.gs[sensor % 3] : r.ps[sensor % 8];
        });
        add(errors[0], run.column("reading")[row] - told);
    }
}

}  // namespace puckloop::gap::emulate
