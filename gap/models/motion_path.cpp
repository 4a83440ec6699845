#include "gap/models/motion_path.h"

#include "gap/models/gravity.h"
#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kDeadBandEdge = 0.004;  // width of the dead band's edge, share of it
constexpr double kLongestSlip = 0.7;     // s: no change of speed costs way for longer
constexpr double kSameRowTime = 1e-6;    // s
constexpr double kLeastChance = 1e-6;    // of losing a command again and again
constexpr double kLeastTurn = 1e-9;      // rad: what rounding of numbers makes
constexpr double kLeastDensity = 1e-300;

}  // namespace

bool settled(const Path& path, double before, double span) {
    return std::ranges::all_of(path.wheel, [&](const WheelCurve& wheel) {
        const auto after = std::ranges::upper_bound(wheel.jumps, before + kSameRowTime, {}, &SpeedJump::time);
        return after == wheel.jumps.begin() || before - (after - 1)->time > 1.5 * span;
    });
}

double let_through(const WheelCurve& asked, CurveReader& pacer, double deadband, double from, double to) {
    auto knot = std::ranges::upper_bound(asked.time, from);
    double all = 0.0, moved = 0.0, at = pacer.at(from);
    while (from < to) {  // in pieces of one speed
        const double end = knot == asked.time.end() ? to : std::min(*knot++, to);
        const double there = pacer.at(end), steps = std::abs(there - at), speed = steps / (end - from);
        if (end > from) {
            all += steps;
            moved += steps / (1 + std::exp(-(speed - deadband) / (kDeadBandEdge * deadband)));
        }
        at = there;
        from = end;
    }
    return all > 0 ? moved / all : 0.0;
}

double slipped(const std::vector<SpeedJump>& jumps, double metre, double inverse_mu, double play, double from,
               double to) {
    double sum = 0.0;
    auto jump = std::ranges::lower_bound(jumps, from - kLongestSlip, {}, &SpeedJump::time);
    for (; jump != jumps.end() && jump->time < to; ++jump) {
        const double speed = std::abs(jump->change) * metre;
        const double lasts = speed * inverse_mu / kGravity;
        const auto done = [&](double t) {
            const double share = std::clamp((t - jump->time) / std::max(lasts, 1e-6), 0.0, 1.0);
            return 1 - (1 - share) * (1 - share);
        };
        double way = speed * lasts / 2;
        if (play > 0 && jump->before * (jump->before + jump->change) < 0)
            way -= std::min(play, std::abs(jump->before * (jump->before + jump->change)) * metre * metre *
                                      inverse_mu / kGravity);
        sum += std::copysign(way, jump->change) * (done(to) - done(from));
    }
    return sum;
}

Loss lost(const std::vector<SpeedJump>& jumps, double drop, double again, double from, double to) {
    const auto after = std::ranges::upper_bound(jumps, from + kSameRowTime, {}, &SpeedJump::time);
    if (after == jumps.begin() || to <= from) return {};
    const SpeedJump& last = *(after - 1);
    const double rows = std::round((from - last.time) / (to - from));
    const double chance = drop * std::pow(again, std::max(rows, 0.0));
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
    std::vector<double> sizes;
    for (std::size_t i = 1; i < above.size(); ++i)
        sizes.push_back(std::abs(above[i] - above[i - 1]));
    if (sizes.empty()) return;
    const double sd = std::max(stats::kMadToSigma * stats::upper_median(std::move(sizes)), kLeastTurn);
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
