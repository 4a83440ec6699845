#include "linuxboard/netmanager/reach.h"

#include <cmath>
#include <deque>

namespace puckloop::netmanager {

namespace {

bool near(const std::optional<Place>& a, const std::optional<Place>& b, const Limits& limits) {
    if (!limits.range || !a || !b) return true;
    return std::hypot(a->x - b->x, a->y - b->y) <= *limits.range;
}

}  // namespace

std::map<int, int> reached(const Places& places, int from, const Limits& limits) {
    std::map<int, int> hops{{from, 0}};
    std::deque<int> frontier{from};
    while (!frontier.empty() && places.contains(from)) {
        const int one = frontier.front();
        frontier.pop_front();
        if (hops[one] == limits.hops) continue;
        for (const auto& [other, place] : places) {
            if (hops.contains(other) || !near(places.at(one), place, limits)) continue;
            hops[other] = hops[one] + 1;
            frontier.push_back(other);
        }
    }
    hops.erase(from);
    return hops;
}

}  // namespace puckloop::netmanager
