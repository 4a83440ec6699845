#include "gap/models/wheel_moments.h"

#include "physics/robot/extension.h"
#include "physics/robot/wheel_drive.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kMoment = 0.02;      // s: no longer than that, unless a row would have more than
constexpr double kMostMoments = 16;   // of them
constexpr double kStandsStill = 0.1;  // steps/s: slower is standing

struct Driven {
    double from, to;
};

/// When a wheel drives the robot, rising.
void add_driven(const WheelCurve& curve, const physics::BodyParameters& robot, std::vector<Driven>& all) {
    double before = 0.0;  // steps/s of the stretch before
    for (std::size_t k = 1; k < curve.time.size(); ++k) {
        const double span = curve.time[k] - curve.time[k - 1];
        if (span <= 0) continue;
        const double rate = std::abs(curve.steps[k] - curve.steps[k - 1]) / span;
        if (rate > kStandsStill) {
            all.push_back({curve.time[k - 1], curve.time[k]});
        } else if (before > kStandsStill) {
            const double interval = 1 / before;
            const double on = physics::WheelDrive::driven_for(interval, robot) - interval / 2;
            if (on > 0) all.push_back({curve.time[k - 1], std::min(curve.time[k - 1] + on, curve.time[k])});
        }
        before = rate;
    }
}

std::vector<Driven> driven_by_either(const Path& path, const physics::BodyParameters& robot) {
    std::vector<Driven> all, joined;
    for (const WheelCurve& curve : path.wheel)
        add_driven(curve, robot, all);
    std::ranges::sort(all, {}, &Driven::from);
    for (const Driven& one : all)
        if (!joined.empty() && one.from <= joined.back().to)
            joined.back().to = std::max(joined.back().to, one.to);
        else
            joined.push_back(one);
    return joined;
}

}  // namespace

void add_wheel_moments(const Path& path, double late, double metre, const physics::BodyParameters& robot,
                       std::uint32_t first, std::vector<WheelMoment>& to) {
    const auto driven = driven_by_either(path, robot);
    auto next = driven.begin();
    CurveReader left(path.wheel[0]), right(path.wheel[1]), left_before(path.wheel[0]),
        right_before(path.wheel[1]), left_end(path.wheel[0]), right_end(path.wheel[1]);
    double travelled = 0.0, left_last = 0.0, right_last = 0.0;
    for (std::size_t i = 0; i < path.time.size(); ++i) {
        const double end = path.time[i] - late;
        if (i == 0) {
            left_last = left_end.at(end);
            right_last = right_end.at(end);
            continue;
        }
        const double begin = path.time[i - 1] - late;
        const double moments = std::clamp(std::ceil((end - begin) / kMoment), 1.0, kMostMoments);
        for (double k = 0; k < moments; ++k) {
            const double from = begin + (end - begin) * k / moments,
                         until = begin + (end - begin) * (k + 1) / moments, middle = (from + until) / 2;
            const double l = left_end.at(until), r = right_end.at(until);
            const double way = std::abs(l - left_last + r - right_last) / 2 * metre;
            left_last = l;
            right_last = r;
            double seconds = 0.0;
            while (next != driven.end() && next->to <= from)
                ++next;
            for (auto one = next; one != driven.end() && one->from < until; ++one)
                seconds += std::min(one->to, until) - std::max(one->from, from);
            if (seconds > 0) {
                const double window = physics::kSpeedWindow;
                const double rolled_left = (left.at(middle) - left_before.at(middle - window)) * metre,
                             rolled_right = (right.at(middle) - right_before.at(middle - window)) * metre;
                to.push_back({first + static_cast<std::uint32_t>(i), (k + 0.5) / moments, seconds,
                              (rolled_left + rolled_right) / 2 / window,
                              (rolled_right - rolled_left) / robot.axle_length / window,
                              travelled + way / 2});
            }
            travelled += way;
        }
    }
}

}  // namespace puckloop::gap
