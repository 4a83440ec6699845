#include "cosim/schedule.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {
// Free stretch, as a part of the stop latency, for which a node nobody waits for is granted all the same.
constexpr Time kStretchDivisor = 4;
}  // namespace

/// Limit of node `n`; where its own messages set it, as if it were silent: it will go in strides, if there is
/// room for the first one.
Time Schedule::limit_if_silent(std::size_t n, Time granted) {
    alone_root_ = bounds_.root(n);
    if (alone_root_ != n || bounds_.limit(n) <= granted) return bounds_.limit(n);
    alone_.compute(*channels_, *pending_, n);
    alone_root_ = alone_.root(n);
    return alone_.limit(n);
}

void Schedule::plan(const std::vector<Channel>& channels, const std::vector<Time>& pending,
                    const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits) {
    channels_ = &channels;
    pending_ = &pending;
    bounds_.compute(channels, pending);
    const std::size_t count = nodes.size();
    reached_ = limits.end;
    for (const NodeTimes& node : nodes)
        reached_ = std::min(reached_, node.granted);
    complete_ = reached_ >= limits.end;
    const Time window = later(reached_, limits.stop_latency);
    const Time ceiling = std::min({window, limits.end, limits.pace});

    target_.assign(count, 0);
    is_root_.assign(count, 0);
    bool busy = false, last_is_root = false;
    for (std::size_t n = 0; n < count; ++n) {
        busy = busy || nodes[n].busy;
        const Time limit = limit_if_silent(n, nodes[n].granted);
        target_[n] = std::min(limit, ceiling);
        if (nodes[n].granted >= limits.end) continue;
        if (bounds_.root(n) == n) is_root_[n] = 1;
        if (limit <= window && alone_root_ != kNobody) is_root_[alone_root_] = 1;
        if (limit > window) last_is_root = true;
    }
    chosen_.clear();
    const auto choose = [&](auto serves) {
        for (std::size_t n = 0; n < count; ++n)
            if (!nodes[n].busy && target_[n] > nodes[n].granted && serves(n)) chosen_.push_back(n);
    };
    choose([&](std::size_t n) {
        return is_root_[n] != 0 || target_[n] == limits.end ||
               (last_is_root && nodes[n].granted == reached_) ||
               target_[n] - nodes[n].granted >= limits.stop_latency / kStretchDivisor;
    });
    if (chosen_.empty() && !busy) choose([](std::size_t) { return true; });
}

}  // namespace puckloop::cosim
