#include "emu/wifi/routes.h"

#include <algorithm>
#include <tuple>

namespace puckloop::wifi {

using cosim::kNever;
using cosim::Time;

namespace {
constexpr std::size_t kTestOctets = 8192 / 8;
}

Routes::Routes(std::size_t stations, std::int64_t most)
    : most_(most), ways_(stations, std::vector<Way>(stations)) {}

/// From station to station with what is known so far (Bellman and Ford), a hop more each time: the cheapest
/// way of so many hops at most. Of equal ones that with fewer hops, then that over the first station.
std::vector<Routes::Way> Routes::ways_from(std::size_t from,
                                           const std::vector<std::vector<Time>>& costs) const {
    const std::size_t count = costs.size();
    std::vector<Time> best(count, kNever);
    std::vector<Way> ways(count);
    best[from] = 0;
    for (std::int64_t hop = 1; hop <= most_; ++hop) {
        const std::vector<Time> before = best;
        const std::vector<Way> ways_before = ways;
        bool changed = false;
        for (std::size_t over = 0; over < count; ++over) {
            if (before[over] == kNever) continue;
            for (std::size_t to = 0; to < count; ++to) {
                if (to == from || to == over || costs[over][to] == kNever) continue;
                const Time cost = before[over] + costs[over][to];
                if (cost >= best[to]) continue;
                best[to] = cost;
                ways[to] = {over == from ? to : ways_before[over].next, ways_before[over].hops + 1};
                changed = true;
            }
        }
        if (!changed) break;
    }
    return ways;
}

std::vector<Routes::Change> Routes::update(const Dcf& dcf) {
    const std::size_t count = ways_.size();
    std::vector<std::vector<Time>> costs(count, std::vector<Time>(count, kNever));
    for (std::size_t from = 0; from < count; ++from)
        for (std::size_t to = 0; to < count; ++to)
            if (from != to && dcf.is_neighbour(from, to))
                costs[from][to] = dcf.time_of(kTestOctets, dcf.rate_for(from, to));
    std::vector<Change> changes;
    for (std::size_t from = 0; from < count; ++from) {
        const std::vector<Way> ways = ways_from(from, costs);
        for (std::size_t to = 0; to < count; ++to)
            if (ways[to] != ways_[from][to]) changes.push_back({from, to, ways[to].next, ways[to].hops});
        ways_[from] = ways;
    }
    return changes;
}

}  // namespace puckloop::wifi
