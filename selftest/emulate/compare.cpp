#include "selftest/emulate/reacts.h"
#include "selftest/emulate/reacts_sensors.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace puckloop::gap::emulate {

namespace {

constexpr double kAround = 0.5;    // s: readings as near as this to a row's time are its mean
constexpr double kSettled = 0.45;  // s after which readings count
constexpr double kWindow = 2.0;    // s of a drive, short beside a run and long beside a push

/// Where the emulated robot was, in its own frame of reference.
struct Pose {
    double x, y, theta;
};

Pose pose_at(const std::vector<Row>& rows, double t) {
    auto after = std::lower_bound(rows.begin(), rows.end(), t,
                                  [](const Row& row, double time) { return row.t < time; });
    if (after == rows.end()) --after;
    if (after == rows.begin() && rows.size() > 1) ++after;
    const Row &b = *after, &a = after == rows.begin() ? b : *(after - 1);
    const double f = b.t > a.t ? std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0) : 0.0;
    return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y),
            a.theta + f * std::remainder(b.theta - a.theta, 2 * std::numbers::pi)};
}

/// From one pose to another, as seen from the first.
Pose between(const Pose& from, const Pose& to) {
    const double c = std::cos(from.theta), s = std::sin(from.theta), x = to.x - from.x, y = to.y - from.y;
    return {c * x + s * y, c * y - s * x, std::remainder(to.theta - from.theta, 2 * std::numbers::pi)};
}

void compare_motion(const Run& run, const React& react, const Performed& performed, const Performed& plain,
                    std::vector<Comparison>& comparisons) {
    const auto& t = run.column("t_s");
    const auto measured_at = [&](std::size_t row) {
        return Pose{run.column("x_m")[row] - react.x, run.column("y_m")[row] - react.y,
                    run.column("theta_rad")[row]};
    };
    std::size_t from = react.rows.front();
    for (const std::size_t row : react.rows) {
        const double now = t[row] - t[0], begun = t[from] - t[0];
        const Pose seen = measured_at(row), pose = pose_at(performed.rows, now);
        comparisons[0].error(std::hypot(seen.x - pose.x, seen.y - pose.y));
        comparisons[1].error(std::remainder(seen.theta - pose.theta, 2 * std::numbers::pi));
        if (now - begun < kWindow) continue;
        // Beside what the simulator as it is would have done in this window.
        const Pose expected = between(pose_at(plain.rows, begun), pose_at(plain.rows, now)),
                   was = between(measured_at(from), seen), is = between(pose_at(performed.rows, begun), pose);
        comparisons[2].measured(std::hypot(was.x - expected.x, was.y - expected.y));
        comparisons[2].performed(std::hypot(is.x - expected.x, is.y - expected.y));
        comparisons[3].measured(std::remainder(was.theta - expected.theta, 2 * std::numbers::pi));
        comparisons[3].performed(std::remainder(is.theta - expected.theta, 2 * std::numbers::pi));
        from = row;
    }
}

/// Differences about their mean: the clocks' zeros are not known.
void add_arrivals(const std::vector<double>& differences, Comparison& arrival) {
    double mean = 0.0;
    for (const double one : differences)
        mean += one / static_cast<double>(differences.size());
    for (const double one : differences)
        arrival.error(one - mean);
}

void compare_line(const Experiment& experiment, const React& react, const std::vector<SerialAnswer>& answers,
                  Comparison& arrival) {
    for (std::size_t k = 0; k < react.rows.size() && !answers.empty(); ++k) {
        const Run& run = experiment.runs[react.rows[k]];
        const SerialAnswer& answer = answers[k % answers.size()];
        std::vector<double> differences;
        for (std::size_t i = 0; i < run.rows; ++i) {
            const auto byte = static_cast<std::size_t>(value_of(run, "seq", i, static_cast<double>(i)));
            const double seen = run.column("t_host_s")[i];
            if (byte < answer.size() && !std::isnan(seen)) differences.push_back(seen - answer[byte]);
        }
        add_arrivals(differences, arrival);
    }
}

void compare_timing(const Run& run, const React& react, const std::vector<Row>& emulated,
                    std::vector<Comparison>& comparisons) {
    constexpr double kPause = 0.05;  // s
    std::vector<double> differences;
    std::size_t compared = 0;
    double seen_last = NAN, performed_last = NAN;
    for (const std::size_t row : react.rows) {
        const auto seq = static_cast<std::size_t>(value_of(run, "seq", row, static_cast<double>(row)));
        if (seq >= emulated.size()) continue;
        const double ok = value_of(run, "frame_ok", row, NAN), seen = run.column("t_host_s")[row],
                     is = emulated[seq].answered;
        const bool whole = !(ok < 0.5) && !std::isnan(seen), is_whole = emulated[seq].ok;
        if (!std::isnan(ok)) {
            comparisons[2].measured(ok < 0.5 ? 1 : 0);
            comparisons[2].performed(is_whole ? 0 : 1);
        }
        if (whole && is_whole) {
            // A loop that paused after broken frames, in either, counts its periods anew (gap/sync/pauses).
            const bool anew = !differences.empty() && seq > compared + 1 &&
                              std::abs(seen - is - differences.back()) > kPause;
            if (anew) add_arrivals(std::exchange(differences, {}), comparisons[0]);
            differences.push_back(seen - is);
            compared = seq;
        }
        // From one whole frame to the next: broken ones in a row make it long.
        if (whole) comparisons[1].measured(seen - std::exchange(seen_last, seen));
        if (is_whole) comparisons[1].performed(is - std::exchange(performed_last, is));
    }
    add_arrivals(differences, comparisons[0]);
}

void compare_placement(const Experiment& experiment, const React& react, const Performed& performed,
                       const Performed& plain, std::vector<Comparison>& comparisons) {
    const bool floor = experiment.kind == Kind::Ground;
    for (std::size_t k = 0; k + 1 < react.rows.size(); k += 2) {
        const Run& run = experiment.runs[react.rows[k]];
        const std::size_t row = react.rows[k + 1];
        const auto sensor = floor ? static_cast<std::size_t>(value_of(run, "sensor", row, 0)) : react.sensor;
        const double t = value_of(run, "t_s", row, 0.0);
        const auto value = [&](const Row& r) { return floor ? r.gs[sensor % 3] : r.ps[sensor % 8]; };
        compare_reading(run.column("reading")[row], standing(performed.rows, t, value),
                        standing(plain.rows, t, value), comparisons[0], comparisons[1]);
    }
}

}  // namespace

std::vector<double> standing(const std::vector<Row>& emulated, double t,
                             const std::function<double(const Row&)>& value) {
    const double about = std::clamp(std::isnan(t) ? 0.0 : t, kSettled, emulated.back().powered);
    std::vector<double> values;
    for (const Row& row : emulated)
        if (row.t >= kSettled && std::abs(row.powered - about) <= kAround && row.ok &&
            !std::isnan(value(row)))
            values.push_back(value(row));
    return values;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

void compare_reading(double reading, const std::vector<double>& performed, const std::vector<double>& plain,
                     Comparison& mean, Comparison& distribution) {
    const double expected = mean_of(plain);
    mean.error(reading - mean_of(performed));
    if (std::isnan(expected)) return;
    distribution.measured(reading - expected);
    for (const double value : performed)
        distribution.performed(value - expected, 1.0 / static_cast<double>(performed.size()));
}

std::vector<std::pair<const char*, const char*>> compared(const Kind& kind) {
    switch (kind) {
    case Kind::Motion:
        return {{"position", "m"},
                {"heading", "rad"},
                {"distribution of way in 2 s", "m"},
                {"distribution of turn in 2 s", "rad"}};
    case Kind::Timing:
        return {{"arrival", "s"}, {"distribution of intervals", "s"}, {"share of broken frames", "1"}};
    case Kind::Microphone:
        return {{"level", "counts"}, {"distribution of levels", "counts"}};
    case Kind::Accelerometer:
        return {{"ax", "counts"},
                {"ay", "counts"},
                {"az", "counts"},
                {"distribution of ax", "counts"},
                {"distribution of ay", "counts"},
                {"distribution of az", "counts"}};
    default:
        return {{"reading", "counts"}, {"distribution of readings", "counts"}};
    }
}

void compare(const Experiment& experiment, const React& react, const Performed& performed,
             const Performed& plain, std::vector<Comparison>& comparisons) {
    if (react.line) return compare_line(experiment, react, performed.answers, comparisons[0]);
    switch (experiment.kind) {
    case Kind::Motion:
        return compare_motion(experiment.runs[react.run], react, performed, plain, comparisons);
    case Kind::Timing:
        return compare_timing(experiment.runs[react.run], react, performed.rows, comparisons);
    case Kind::Microphone:
        return compare_microphone(experiment, react, performed, plain, comparisons);
    case Kind::Accelerometer:
        return compare_accelerometer(experiment, react, performed, plain, comparisons);
    default:
        return compare_placement(experiment, react, performed, plain, comparisons);
    }
}

}  // namespace puckloop::gap::emulate
