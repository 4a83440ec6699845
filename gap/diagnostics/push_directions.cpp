#include "gap/diagnostics/push_directions.h"

#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kTakenBack = 0.3;  // of a push, at most, that is left after the next
constexpr double kByChance = kTakenBack / std::numbers::pi;  // of pushes of one length; of normal ones fewer

/// Successive pushes of a run: in how many pairs is this below 0, as by chance it is in a share `chance`?
PushPattern below_nothing(const std::vector<Push>& pushes, double all, std::string where, double chance,
                          double (*of)(const Push&, const Push&)) {
    unsigned pairs = 0, below = 0;
    for (std::size_t k = 1; k < pushes.size(); ++k) {
        const double value = of(pushes[k - 1], pushes[k]);
        if (pushes[k].begins || !std::isfinite(value)) continue;
        pairs += 1;
        below += value < 0 ? 1 : 0;
    }
    return {std::move(where), static_cast<double>(below), all, pairs * chance,
            stats::binomial_tail(pairs, chance, below)};
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
    const char* against = "against the push before";
    return {below_nothing(pushes, all, against, 0.5,
                          [](const Push& a, const Push& b) { return b.x * a.x + b.y * a.y; }),
            below_nothing(pushes, all, against, 0.5,
                          [](const Push& a, const Push& b) { return b.turned * a.turned; }),
            below_nothing(pushes, all, "back to where the push before began", kByChance,
                          [](const Push& a, const Push& b) {
                              return std::hypot(a.x + b.x, a.y + b.y) - kTakenBack * std::hypot(a.x, a.y);
                          }),
            below_nothing(pushes, all, "back to where the push before began to turn", kByChance,
                          [](const Push& a, const Push& b) {
                              return std::abs(a.turned + b.turned) - kTakenBack * std::abs(a.turned);
                          }),
            directed(room, all, "towards one side of the room"),
            directed(both_ways(room), all, "along one line of the room"),
            directed(robot, all, "one way as the robot looks"),
            directed(both_ways(robot), all, "along one line of the robot"),
            turned_one_way(pushes, all)};
}

}  // namespace puckloop::gap
