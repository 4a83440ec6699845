#include "gap/diagnostics/push_directions.h"

#include "gap/stats/tails.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

namespace puckloop::gap {

namespace {

/// Successive pushes of a run, and how many of them go against the one before.
struct Successive {
    unsigned pairs = 0, against = 0;

    void take(double product) {
        if (!std::isfinite(product)) return;
        pairs += 1;
        against += product < 0 ? 1 : 0;
    }
    PushDirection verdict() const {
        return {"against the push before", static_cast<double>(against), pairs / 2.0,
                stats::binomial_tail(pairs, 0.5, against)};
    }
};

/// By the angle between them in the room, and by the sense in which they turn.
std::array<Successive, 2> successive(const std::vector<Push>& pushes) {
    std::array<Successive, 2> all;
    for (std::size_t k = 1; k < pushes.size(); ++k) {
        const Push &last = pushes[k - 1], &now = pushes[k];
        if (now.begins) continue;
        all[0].take(now.x * last.x + now.y * last.y);
        all[1].take(now.turned * last.turned);
    }
    return all;
}

/// Do these unit vectors keep to a direction (Rayleigh's test: Mardia and Jupp, Directional Statistics,
/// 2000)?
PushDirection directed(const std::vector<std::complex<double>>& ways, std::string where) {
    std::complex<double> sum = 0.0;
    for (const auto& way : ways)
        sum += way;
    const auto count = static_cast<double>(ways.size());
    const auto near =
        std::ranges::count_if(ways, [&](const auto& way) { return (way * std::conj(sum)).real() > 0; });
    return {std::move(where), static_cast<double>(near), count / 2,
            stats::rayleigh_tail(static_cast<unsigned>(ways.size()), std::abs(sum))};
}

/// Most of them to the left, or most to the right?
PushDirection turned_one_way(const std::vector<Push>& pushes) {
    unsigned left = 0, all = 0;
    for (const Push& one : pushes) {
        if (!std::isfinite(one.turned)) continue;
        all += 1;
        left += one.turned > 0 ? 1 : 0;
    }
    const unsigned most = std::max(left, all - left);
    return {"to one side in turning", static_cast<double>(most), all / 2.0,
            std::min(2 * stats::binomial_tail(all, 0.5, most), 1.0)};
}

}  // namespace

std::vector<PushDirection> push_directions(const std::vector<Push>& pushes) {
    std::vector<PushDirection> all;
    for (const Successive& one : successive(pushes))
        all.push_back(one.verdict());
    std::vector<std::complex<double>> room, robot;
    for (const Push& one : pushes) {
        const std::complex<double> way(one.x, one.y);
        if (!(std::abs(way) > 0) || !std::isfinite(std::abs(way))) continue;
        room.push_back(way / std::abs(way));
        robot.push_back(room.back() * std::polar(1.0, -one.heading));
    }
    const auto both_ways = [](std::vector<std::complex<double>> ways) {
        for (auto& way : ways)
            way *= way;  // along a line: an angle and its opposite are one
        return ways;
    };
    all.push_back(directed(room, "towards one side of the room"));
    all.push_back(directed(both_ways(room), "along one line of the room"));
    all.push_back(directed(robot, "one way as the robot looks"));
    all.push_back(directed(both_ways(robot), "along one line of the robot"));
    all.push_back(turned_one_way(pushes));
    return all;
}

}  // namespace puckloop::gap
