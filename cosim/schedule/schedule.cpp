#include "cosim/schedule/schedule.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {
// Free stretch, as a part of the stop latency, for which a node nobody waits for is granted all the same.
constexpr Time kStretchDivisor = 4;
}  // namespace

/// Limit of node `n`, which its own messages set, as if it were silent: it will go in strides.
Time Schedule::limit_if_silent(std::size_t n) {
    alone_.compute(*channels_, *pending_, n);
    return alone_.limit(n);
}

/// When something may happen at each node next, if nothing new comes in.
void Schedule::find_next(const std::vector<NodeTimes>& nodes, Time end) {
    next_ = *pending_;
    for (const Channel& channel : *channels_)
        next_[channel.from] = std::min(next_[channel.from], channel.base);
    // How far the first one may go: whatever happens within that time happens beside it.
    std::size_t first = kNobody;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n].granted < end && (first == kNobody || next_[n] < next_[first])) first = n;
    if (first != kNobody) round_ = std::max(next_[first], bounds_.limit(first));
}

void Schedule::plan(const std::vector<Channel>& channels, const std::vector<Time>& pending,
                    const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits) {
    channels_ = &channels;
    pending_ = &pending;
    bounds_.compute(channels, pending);
    find_next(nodes, limits.end);
    const std::size_t count = nodes.size();
    reached_ = limits.end;
    for (const NodeTimes& node : nodes)
        reached_ = std::min(reached_, node.granted);
    complete_ = reached_ >= limits.end;
    const Time window = later(reached_, limits.stop_latency);
    const Time ceiling = std::min({window, limits.end, limits.pace});

    target_.assign(count, 0);
    bool busy = false, last_holds_up = false;
    for (std::size_t n = 0; n < count; ++n) {
        busy = busy || nodes[n].busy;
        const Time limit = bounds_.limit(n);
        target_[n] = std::min(limit, ceiling);
        if (nodes[n].granted < limits.end && limit > window) last_holds_up = true;
    }
    chosen_.clear();
    const auto choose = [&](auto serves) {
        for (std::size_t n = 0; n < count; ++n)
            if (!nodes[n].busy && target_[n] > nodes[n].granted && serves(n)) chosen_.push_back(n);
    };
    choose([&](std::size_t n) {
        return next_[n] <= round_ || target_[n] == limits.end ||
               (last_holds_up && nodes[n].granted == reached_) ||
               target_[n] - nodes[n].granted >= limits.stop_latency / kStretchDivisor;
    });
    if (chosen_.empty() && !busy) choose([](std::size_t) { return true; });
    for (const std::size_t n : chosen_)
        if (bounds_.root(n) == n) target_[n] = std::min(limit_if_silent(n), ceiling);
}

}  // namespace puckloop::cosim
