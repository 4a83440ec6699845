#include "selftest/emulate/reacts.h"

#include "base/quantile.h"
#include "physics/description/parameters.h"
#include "protocols/serial/epuck_serial.h"
#include "selftest/emulate/plans.h"
#include "selftest/emulate/reacts_sensors.h"
#include "selftest/emulate/surroundings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

namespace puckloop::gap::emulate {

namespace {

constexpr double kStanding = 1.0;        // s of an act without a motion of its own, at least
constexpr double kSmallestArena = 6.0;   // m
constexpr double kMargin = 1.0;          // m between the measured path and a wall
constexpr std::size_t kPlacements = 24;  // of a proximity experiment
constexpr double kClear = 0.0005;        // m between body and wall
constexpr double kFine = 1e-5;           // m and rad: closer placements are one

double median_step(const std::vector<double>& times) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i)
        if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
    return steps.empty() ? 0.0 : upper_median(std::move(steps));
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

/// Rows are the bytes of an answer, a run each, as a logic analyser times them.
bool is_line(const Run& run) {
    constexpr double kNear = 0.01;
    return run.rows >= 3 && run.rows <= protocols::kEpuckSensorBytes &&
           std::abs(value_of(run, "nominal_period", 0, 0.1) / kSerialByte - 1) < kNear;
}

/// One standing robot answers as often as there are runs.
std::vector<React> line(const Experiment& experiment) {
    constexpr double kStart = 1.5, kAnswer = 0.1;  // s
    React react;
    react.line = true;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r)
        if (is_line(experiment.runs[r])) react.rows.push_back(r);
    react.act.arena = open_floor(0);
    react.act.commands = {{0, 0, 0}, {kStart + kAnswer * static_cast<double>(react.rows.size()), 0, 0}};
    return react.rows.empty() ? std::vector<React>{} : std::vector<React>{react};
}

std::vector<React> timing(const Experiment& experiment, std::string& why) {
    constexpr double kLeastPeriod = 0.01;  // s: an exchange takes 8 ms on the line
    std::vector<React> reacts = line(experiment);
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
    if (reacts.empty())
        why = "no run with three frames, 10 ms or more apart, or with an answer's bytes at 115200 baud";
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
        return microphone_reacts(experiment, longest, why);
    case Kind::Accelerometer:
        return accelerometer_reacts(experiment, longest, why);
    default:
        why = fmt::format("experiments of kind {} are not performed again", kind_name(experiment.kind));
        return {};
    }
}

}  // namespace puckloop::gap::emulate
