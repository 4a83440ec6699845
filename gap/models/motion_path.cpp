#include "gap/models/motion_path.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kEdge = 0.004;  // width of the dead band's edge, share of it
constexpr double kGravity = 9.81;
constexpr double kLongestSlip = 0.7;   // s: no change of speed costs way for longer
constexpr double kSameTime = 1e-6;     // s
constexpr double kLeastChance = 1e-6;  // of losing a command again and again

void add_paces(const WheelCurve& curve, double from, double to, std::vector<Pace>& paces) {
    CurveReader reader(curve);
    auto knot = std::upper_bound(curve.time.begin(), curve.time.end(), from);
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
    return std::all_of(path.wheel, path.wheel + 2, [&](const WheelCurve& wheel) {
        const auto after = std::upper_bound(wheel.jumps.begin(), wheel.jumps.end(), before + kSameTime,
                                            [](double t, const SpeedJump& j) { return t < j.time; });
        return after == wheel.jumps.begin() || before - (after - 1)->time > 1.5 * span;
    });
}

}  // namespace

Driven driven_by(const Path& path, double late) {
    Driven driven;
    const std::size_t n = path.time.size();
    for (std::size_t w = 0; w < 2; ++w) {
        Driven::Wheel& wheel = driven.wheel[w];
        const WheelCurve &done = path.wheel[w], &told = pace_of(path, w);
        CurveReader reader(done), pacer(told);
        const auto& jumps = done.jumps;
        for (std::vector<double>* one : {&wheel.steps, &wheel.asked})
            one->reserve(n);
        for (std::vector<std::uint32_t>* one : {&wheel.first_jump, &wheel.last_jump})
            one->reserve(n);
        double last = 0.0, last_pace = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const double now = path.time[i] - late, before = i == 0 ? now : path.time[i - 1] - late;
            const double steps = reader.at(now), pace = &told == &done ? steps : pacer.at(now);
            wheel.steps.push_back(i == 0 ? 0.0 : steps - last);
            wheel.asked.push_back(i == 0 ? 0.0 : std::abs(pace - last_pace));
            last = steps;
            last_pace = pace;
            const auto first = std::lower_bound(jumps.begin(), jumps.end(), before - kLongestSlip,
                                                [](const SpeedJump& j, double t) { return j.time < t; });
            const auto end = std::lower_bound(first, jumps.end(), now,
                                              [](const SpeedJump& j, double t) { return j.time < t; });
            wheel.first_jump.push_back(static_cast<std::uint32_t>(first - jumps.begin()));
            wheel.last_jump.push_back(static_cast<std::uint32_t>(end - jumps.begin()));
        }
    }
    return driven;
}

Paced paced_by(const Path& path, std::size_t wheel, double late) {
    Paced paced;
    for (std::size_t i = 0; i < path.time.size(); ++i) {
        if (i > 0) add_paces(pace_of(path, wheel), path.time[i - 1] - late, path.time[i] - late, paced.paces);
        paced.last.push_back(static_cast<std::uint32_t>(paced.paces.size()));
    }
    return paced;
}

std::vector<char> settled_rows(const Path& path, double late) {
    std::vector<char> rows;
    for (std::size_t i = 0; i < path.time.size(); ++i) {
        const double now = path.time[i] - late, before = i == 0 ? now : path.time[i - 1] - late;
        rows.push_back(settled(path, before, now - before) ? 1 : 0);
    }
    return rows;
}

const WheelCurve& pace_of(const Path& path, std::size_t wheel) {
    return path.asked[wheel].empty() ? path.wheel[wheel] : path.asked[wheel];
}

double let_through(const Paced& wheel, std::size_t row, double deadband) {
    double all = 0.0, moved = 0.0;
    for (std::uint32_t k = row == 0 ? 0 : wheel.last[row - 1]; k < wheel.last[row]; ++k) {
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
    const auto after = std::upper_bound(jumps.begin(), jumps.end(), from + kSameTime,
                                        [](double t, const SpeedJump& j) { return t < j.time; });
    if (after == jumps.begin() || to <= from) return {};
    const SpeedJump& last = *(after - 1);
    const double again = std::round((from - last.time) / (to - from));
    const double chance = std::pow(drop, 1 + std::max(again, 0.0));
    if (chance < kLeastChance) return {};
    return {chance, std::abs(last.change) * (to - from)};
}

}  // namespace puckloop::gap
