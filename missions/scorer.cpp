#include "missions/scorer.h"

#include <algorithm>
#include <utility>

namespace puckloop::missions {

namespace {

constexpr std::size_t kPoints =
    100;  // a side: the mean distance is taken over a lattice, not over drawn points

}  // namespace

Scorer::Scorer(Mission mission) : mission_(std::move(mission)), ages_(mission_.cells * mission_.cells, 0) {}

bool Scorer::in_spot(const Place& place) const {
    return std::any_of(mission_.spots.begin(), mission_.spots.end(),
                       [&](const Region& spot) { return spot.holds(place); });
}

void Scorer::step(std::span<const Place> robots) {
    ++steps_;
    last_.assign(robots.begin(), robots.end());
    switch (mission_.kind) {
    case Kind::Aggregation:
        sum_ += static_cast<double>(
            std::count_if(robots.begin(), robots.end(), [&](const Place& place) { return in_spot(place); }));
        break;
    case Kind::Foraging:
        forage(robots);
        break;
    case Kind::GridExploration:
        explore(robots);
        break;
    case Kind::Coverage:
        break;
    }
}

/// A robot takes an item in a spot, one at a time, and leaves it in the nest.
void Scorer::forage(std::span<const Place> robots) {
    carries_.resize(robots.size(), false);
    for (std::size_t i = 0; i < robots.size(); ++i) {
        if (in_spot(robots[i])) {
            carries_[i] = true;
        } else if (mission_.nest.holds(robots[i])) {
            if (carries_[i]) sum_ += 1.0;
            carries_[i] = false;
        }
    }
}

void Scorer::explore(std::span<const Place> robots) {
    for (std::uint64_t& age : ages_)
        ++age;
    const Region& area = mission_.area;
    const auto cells = static_cast<double>(mission_.cells);
    for (const Place& place : robots) {
        if (!area.holds(place)) continue;
        const auto cell = [&](double from_edge, double size) {
            return std::min(static_cast<std::size_t>(from_edge / size * cells), mission_.cells - 1);
        };
        ages_[cell(place.y - area.y + area.width / 2, area.width) * mission_.cells +
              cell(place.x - area.x + area.length / 2, area.length)] = 0;
    }
    double all = 0.0;
    for (const std::uint64_t age : ages_)
        all += static_cast<double>(age);
    sum_ -= all / static_cast<double>(ages_.size());
}

/// Infinite without a robot that counts.
double Scorer::mean_distance() const {
    const Region& area = mission_.area;
    double sum = 0.0;
    std::size_t points = 0;
    const double length = area.disc ? 2 * area.radius : area.length,
                 width = area.disc ? 2 * area.radius : area.width;
    for (std::size_t row = 0; row < kPoints; ++row)
        for (std::size_t column = 0; column < kPoints; ++column) {
            const auto share = [](std::size_t index) {
                return (static_cast<double>(index) + 0.5) / kPoints - 0.5;
            };
            const Place point{area.x + length * share(column), area.y + width * share(row)};
            if (!area.holds(point)) continue;
            double nearest = HUGE_VAL;
            for (const Place& robot : last_)
                if (!in_spot(robot))
                    nearest = std::min(nearest, std::hypot(robot.x - point.x, robot.y - point.y));
            sum += nearest;
            ++points;
        }
    return points == 0 ? HUGE_VAL : sum / static_cast<double>(points);
}

double Scorer::score() const {
    if (steps_ == 0) return 0.0;
    if (mission_.kind == Kind::Coverage) return mean_distance();
    if (mission_.kind == Kind::Aggregation && mission_.at_end) {
        const auto inside =
            std::count_if(last_.begin(), last_.end(), [&](const Place& place) { return in_spot(place); });
        return last_.empty() ? 0.0 : static_cast<double>(inside) / static_cast<double>(last_.size());
    }
    return sum_;
}

}  // namespace puckloop::missions
