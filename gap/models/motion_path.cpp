#include "gap/models/motion_path.h"

#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kEdge = 0.004;  // width of the dead band's edge, share of it
constexpr double kGravity = 9.81;
constexpr double kLongestSlip = 0.7;   // s: no change of speed costs way for longer
constexpr double kSameTime = 1e-6;     // s
constexpr double kLeastChance = 1e-6;  // of losing a command again and again
constexpr double kLeastTurn = 1e-9;    // rad: what rounding of numbers makes
constexpr double kLeastDensity = 1e-300;

void add_paces(const WheelCurve& curve, CurveReader& reader, double from, double to,
               std::vector<Pace>& paces) {
    auto knot = std::ranges::upper_bound(curve.time, from);
    double at = reader.at(from);
    while (from < to) {
        const double end = knot == curve.time.end() ? to : std::min(*knot++, to);
        const double there = reader.at(end), steps = std::abs(there - at);
        if (end > from) paces.push_back({steps, steps / (end - from)});
        at = there;
        from = end;
    }
}

bool settled(const Path& path, double before, double span) {
    return std::ranges::all_of(path.wheel, [&](const WheelCurve& wheel) {
        const auto after = std::ranges::upper_bound(wheel.jumps, before + kSameTime, {}, &SpeedJump::time);
        return after == wheel.jumps.begin() || before - (after - 1)->time > 1.5 * span;
    });
}

Driven::Wheel driven_wheel(const WheelCurve& done, const WheelCurve& asked, const std::vector<double>& time,
                           double late) {
    Driven::Wheel wheel;
    CurveReader reader(done), pacer(asked), pieces(asked);
    const auto jump_from = [&](double t) {
        return static_cast<std::uint32_t>(std::ranges::lower_bound(done.jumps, t, {}, &SpeedJump::time) -
                                          done.jumps.begin());
    };
    double last = 0.0, last_asked = 0.0;
    for (std::size_t i = 0; i < time.size(); ++i) {
        const double now = time[i] - late, before = i == 0 ? now : time[i - 1] - late;
        const double steps = reader.at(now), commanded = &asked == &done ? steps : pacer.at(now);
        wheel.steps.push_back(i == 0 ? 0.0 : steps - last);
        wheel.asked.push_back(i == 0 ? 0.0 : std::abs(commanded - last_asked));
        last = steps;
        last_asked = commanded;
        wheel.first_jump.push_back(jump_from(before - kLongestSlip));
        wheel.last_jump.push_back(jump_from(now));
        if (i > 0) add_paces(asked, pieces, before, now, wheel.paces);
        wheel.last_pace.push_back(static_cast<std::uint32_t>(wheel.paces.size()));
    }
    return wheel;
}

}  // namespace

Driven driven_by(const Path& path, double late) {
    Driven driven;
    for (std::size_t w = 0; w < 2; ++w)
        driven.wheel[w] = driven_wheel(path.wheel[w], pace_of(path, w), path.time, late);
    for (std::size_t i = 0; i < path.time.size(); ++i) {
        const double now = path.time[i] - late, before = i == 0 ? now : path.time[i - 1] - late;
        driven.settled.push_back(settled(path, before, now - before) ? 1 : 0);
    }
    return driven;
}

const WheelCurve& pace_of(const Path& path, std::size_t wheel) {
    return path.asked[wheel].empty() ? path.wheel[wheel] : path.asked[wheel];
}

double let_through(const Driven::Wheel& wheel, std::size_t row, double deadband) {
    double all = 0.0, moved = 0.0;
    for (std::uint32_t k = row == 0 ? 0 : wheel.last_pace[row - 1]; k < wheel.last_pace[row]; ++k) {
        const Pace& pace = wheel.paces[k];
        all += pace.steps;
        moved += pace.steps / (1 + std::exp(-(pace.speed - deadband) / (kEdge * deadband)));
    }
    return all > 0 ? moved / all : 0.0;
}

double slipped(std::span<const SpeedJump> jumps, double metre, double inverse_mu, double play, double from,
               double to) {
    double sum = 0.0;
    for (const SpeedJump& jump : jumps) {
        const double speed = std::abs(jump.change) * metre;
        const double lasts = speed * inverse_mu / kGravity;
        const auto done = [&](double t) {
            const double share = std::clamp((t - jump.time) / std::max(lasts, 1e-6), 0.0, 1.0);
            return 1 - (1 - share) * (1 - share);
        };
        double way = speed * lasts / 2;
        if (play > 0 && jump.before * (jump.before + jump.change) < 0)
            way -= std::min(play, std::abs(jump.before * (jump.before + jump.change)) * metre * metre *
                                      inverse_mu / kGravity);
        sum += std::copysign(way, jump.change) * (done(to) - done(from));
    }
    return sum;
}

Loss lost(const std::vector<SpeedJump>& jumps, double drop, double from, double to) {
    const auto after = std::ranges::upper_bound(jumps, from + kSameTime, {}, &SpeedJump::time);
    if (after == jumps.begin() || to <= from) return {};
    const SpeedJump& last = *(after - 1);
    const double again = std::round((from - last.time) / (to - from));
    const double chance = std::pow(drop, 1 + std::max(again, 0.0));
    if (chance < kLeastChance) return {};
    return {chance, -last.change * (to - from)};
}

void heading_errors(std::span<const double> above, std::span<const double> time, double span,
                    std::span<const double> kept, std::vector<double>& errors) {
    const std::size_t n = above.size();
    errors.assign(n, 0.0);
    thread_local std::vector<double> sums, weights;
    sums.resize(n);
    weights.resize(n);
    double sum = 0.0, weight = 0.0, faded = 0.0, step = -1.0;
    const auto fade_over = [&](std::size_t row) {
        const double seconds = time[row] - time[row - 1];
        if (seconds != step) faded = std::exp(-(step = seconds) / span);
        const double left = kept.empty() ? faded : faded * kept[row];
        sum *= left;
        weight *= left;
    };
    for (std::size_t i = 0; i < n; ++i) {
        if (i > 0) fade_over(i);
        sums[i] = sum += above[i];
        weights[i] = weight += 1.0;
    }
    sum = weight = 0.0;
    for (std::size_t i = n; i-- > 0;) {
        errors[i] = above[i] - (sums[i] + sum) / (weights[i] + weight);
        sum += above[i];
        weight += 1.0;
        if (i > 0) fade_over(i);
    }
}

void kept_headings(std::span<const double> above, const Turned& turned, std::vector<double>& kept) {
    kept.assign(above.size(), 1.0);
    thread_local std::vector<double> sizes;
    sizes.clear();
    for (std::size_t i = 1; i < above.size(); ++i)
        sizes.push_back(std::abs(above[i] - above[i - 1]));
    if (sizes.empty()) return;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::ranges::nth_element(sizes, middle);
    const double sd = std::max(stats::kMadToSigma * *middle, kLeastTurn);
    for (std::size_t i = 1; i < above.size(); ++i) {
        // A walk of q a row under noise of r is best followed by what fades by sqrt(q / r) a row, where that
        // is little (the steady Kalman gain); a step has twice the noise of a heading.
        if (!turned.variance.empty()) kept[i] = std::exp(-std::sqrt(2 * turned.variance[i]) / sd);
        if (turned.chance.empty()) continue;
        const double off = (above[i] - above[i - 1]) / sd, wide = std::hypot(turned.turn[i] / sd, 1.0);
        const double pushed = turned.chance[i] / wide * std::exp(-off * off / (2 * wide * wide)),
                     calm = (1 - turned.chance[i]) * std::exp(-off * off / 2);
        kept[i] *= calm / std::max(pushed + calm, kLeastDensity);
    }
}

}  // namespace puckloop::gap
