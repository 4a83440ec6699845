#include "cosim/schedule/windows.h"

#include <algorithm>
#include <numeric>

namespace puckloop::cosim {

void Windows::connect(const std::vector<Channel>& channels, const std::vector<Sampling>& sampling,
                      std::size_t nodes) {
    edges_.clear();
    looks_.assign(nodes, false);
    turn_.assign(nodes, false);
    first_.clear();
    for (std::size_t n = 0; n < nodes; ++n) {
        first_.push_back(edges_.size());
        for (std::size_t c = 0; c < channels.size(); ++c)
            if (channels[c].from == n)
                edges_.push_back(
                    {static_cast<std::uint32_t>(channels[c].to), sampling[c], static_cast<std::uint32_t>(c)});
    }
    first_.push_back(edges_.size());
    base_.resize(nodes);
    lookahead_.resize(nodes);
    order_.resize(nodes);
    std::iota(order_.begin(), order_.end(), 0U);
    for (std::size_t n = 0; n < nodes; ++n)
        update(n, channels);
}

void Windows::update(std::size_t n, const std::vector<Channel>& channels) {
    Time base = kNever, lookahead = kNever;
    for (std::size_t e = first_[n]; e < first_[n + 1]; ++e) {
        Edge& edge = edges_[e];
        edge.base = channels[edge.channel].base;
        edge.lookahead = channels[edge.channel].lookahead;
        base = std::min(base, edge.base);
        lookahead = std::min(lookahead, edge.lookahead);
    }
    base_[n] = base;
    lookahead_[n] = lookahead;
}

void Windows::plan(const std::vector<Time>& pending, const std::vector<Time>& acting,
                   const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits) {
    reached_ = limits.end;
    for (const NodeTimes& node : nodes)
        reached_ = std::min(reached_, node.granted);
    complete_ = reached_ >= limits.end;
    chosen_.clear();
    find_earliest(pending, acting, nodes);
    find_limits();
    if (!complete_) choose(pending, nodes, limits);
}

/// The first instant at which something reaches each node: from EOTs and what is pending along the shortest
/// ways. Begun with the earliest, hardly a node comes twice.
void Windows::find_earliest(const std::vector<Time>& pending, const std::vector<Time>& acting,
                            const std::vector<NodeTimes>& nodes) {
    earliest_ = pending;
    acting_ = acting;
    for (const Edge& edge : edges_) {
        earliest_[edge.to] = std::min(earliest_[edge.to], edge.base);
        if (!edge.sampling.sampled) acting_[edge.to] = std::min(acting_[edge.to], edge.base);
    }
    // What a node samples may come from before where it is, and changes nothing there.
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        earliest_[n] = std::max(earliest_[n], nodes[n].granted);
        acting_[n] = std::max(acting_[n], nodes[n].granted);
    }
    sort_again(order_, earliest_);
    relaxed_.assign(earliest_.size(), false);
    for (bool changed = true; changed;) {
        changed = false;
        for (const std::uint32_t n : order_) {
            if (relaxed_[n]) continue;
            relaxed_[n] = true;
            if (lookahead_[n] == kNever) continue;
            for (std::size_t e = first_[n]; e < first_[n + 1]; ++e) {
                const Edge& edge = edges_[e];
                const Time there = std::max(later(cause(n, edge), edge.lookahead), nodes[edge.to].granted);
                bool lower = there < earliest_[edge.to];
                if (lower) earliest_[edge.to] = there;
                if (!edge.sampling.sampled && there < acting_[edge.to]) {
                    acting_[edge.to] = there;
                    lower = true;
                }
                if (!lower) continue;
                relaxed_[edge.to] = false;
                changed = true;
            }
        }
    }
}

void Windows::find_limits() {
    limit_.assign(earliest_.size(), kNever);
    known_.assign(earliest_.size(), kNever);
    answered_.assign(earliest_.size(), kNever);
    floor_ = kNever;
    for (std::size_t n = 0; n < earliest_.size(); ++n)
        for (std::size_t e = first_[n]; e < first_[n + 1]; ++e) {
            const Edge& edge = edges_[e];
            const Time time = std::min(edge.base, later(cause(n, edge), edge.lookahead));
            Time& until = edge.sampling.sampled                   ? known_[edge.to]
                          : edge.sampling.turns && turn_[edge.to] ? answered_[edge.to]
                                                                  : limit_[edge.to];
            until = std::min(until, time);
            floor_ = std::min(floor_, time);
        }
}

void Windows::choose(const std::vector<Time>& pending, const std::vector<NodeTimes>& nodes,
                     const ScheduleLimits& limits) {
    const Time end = limits.end, window = later(reached_, limits.stop_latency),
               ceiling = std::min(window, end), stretch = limits.stop_latency / kStretchDivisor;
    bool last_holds_up = false;
    // When others may see something of each next; and how far the first one may go: whatever happens within
    // that time happens beside it.
    next_.resize(nodes.size());
    std::size_t first = kNobody;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        next_[n] = std::min(base_[n], later(pending[n], lookahead_[n]));
        if (nodes[n].granted >= end) continue;
        if (!waits_to_look(n, nodes[n].granted) && (first == kNobody || next_[n] < next_[first])) first = n;
        last_holds_up = last_holds_up || limit_[n] > window;
    }
    if (first == kNobody) return;
    const Time round = std::max(next_[first], std::min(limit_[first], known_[first]));
    for (const bool any : {false, true}) {
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            const Time until = std::min(limit_[n], ceiling), granted = nodes[n].granted;
            if (until <= granted || waits_to_look(n, granted)) continue;
            if (any || next_[n] <= round || until == end || (last_holds_up && granted == reached_) ||
                until - granted >= stretch)
                chosen_.push_back({n, until, known_[n], answered_[n]});
        }
        if (!chosen_.empty()) return;
    }
}

}  // namespace puckloop::cosim
