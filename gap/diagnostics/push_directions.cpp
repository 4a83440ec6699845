#include "gap/diagnostics/push_directions.h"

#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

namespace puckloop::gap {

namespace {

/// Successive pushes of a run: how many go against the one before, by a product of both?
PushPattern against_the_last(const std::vector<Push>& pushes, double all,
                             double (*product)(const Push&, const Push&)) {
    unsigned pairs = 0, against = 0;
    for (std::size_t k = 1; k < pushes.size(); ++k) {
        const double sense = product(pushes[k - 1], pushes[k]);
        if (pushes[k].begins || !std::isfinite(sense)) continue;
        pairs += 1;
        against += sense < 0 ? 1 : 0;
    }
    return {"against the push before", static_cast<double>(against), all, pairs / 2.0,
            stats::binomial_tail(pairs, 0.5, against)};
}

/// Do these unit vectors keep to a direction (Rayleigh's test: Mardia and Jupp, Directional Statistics,
/// 2000)?
PushPattern directed(const std::vector<std::complex<double>>& ways, double all, std::string where) {
    std::complex<double> sum = 0.0;
    for (const auto& way : ways)
        sum += way;
    const auto count = static_cast<double>(ways.size());
    const auto near =
        std::ranges::count_if(ways, [&](const auto& way) { return (way * std::conj(sum)).real() > 0; });
    return {std::move(where), static_cast<double>(near), all, count / 2,
            stats::rayleigh_tail(static_cast<unsigned>(ways.size()), std::abs(sum))};
}

/// Most of them to the left, or most to the right?
PushPattern turned_one_way(const std::vector<Push>& pushes, double all) {
    unsigned left = 0, turned = 0;
    for (const Push& one : pushes) {
        if (!std::isfinite(one.turned)) continue;
        turned += 1;
        left += one.turned > 0 ? 1 : 0;
    }
    const unsigned most = std::max(left, turned - left);
    return {"to one side in turning", static_cast<double>(most), all, turned / 2.0,
            std::min(2 * stats::binomial_tail(turned, 0.5, most), 1.0)};
}

}  // namespace

std::vector<PushPattern> push_directions(const std::vector<Push>& pushes, double all) {
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
    return {against_the_last(pushes, all, [](const Push& a, const Push& b) { return b.x * a.x + b.y * a.y; }),
            against_the_last(pushes, all, [](const Push& a, const Push& b) { return b.turned * a.turned; }),
            directed(room, all, "towards one side of the room"),
            directed(both_ways(room), all, "along one line of the room"),
            directed(robot, all, "one way as the robot looks"),
            directed(both_ways(robot), all, "along one line of the robot"),
            turned_one_way(pushes, all)};
}

}  // namespace puckloop::gap
