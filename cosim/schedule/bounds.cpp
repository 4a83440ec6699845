#include "cosim/schedule/bounds.h"

#include <algorithm>
#include <numeric>

namespace puckloop::cosim {

Time Channel::first_change(Time time) const {
    const auto changed =
        std::lower_bound(foreseen.begin(), foreseen.end(), time,
                         [this](const Foreseen& message, Time t) { return !may_change(message.stamp, t); });
    return changed == foreseen.end() ? kNever : changed->delivery;
}

/// Lists of the channels that leave each node; they hardly ever change.
void Bounds::build_adjacency(std::size_t nodes) {
    const auto same = [this](const Channel& channel) {
        const std::size_t index = static_cast<std::size_t>(&channel - channels_->data());
        return ends_[index] == std::pair(channel.from, channel.to);
    };
    if (leaving_.size() == nodes && ends_.size() == channels_->size() &&
        std::all_of(channels_->begin(), channels_->end(), same))
        return;
    ends_.clear();
    leaving_.assign(nodes, {});
    order_.resize(nodes);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    for (std::size_t c = 0; c < channels_->size(); ++c) {
        const Channel& channel = (*channels_)[c];
        ends_.emplace_back(channel.from, channel.to);
        leaving_[channel.from].push_back(c);
    }
}

void Bounds::compute(const std::vector<Channel>& channels, const std::vector<Time>& pending,
                     std::size_t silent) {
    channels_ = &channels;
    pending_ = &pending;
    silent_ = silent;
    build_adjacency(pending.size());
    earliest_ = pending;
    for (const Channel& channel : channels)
        if (channel.from != silent && channel.base < earliest_[channel.to])
            earliest_[channel.to] = channel.base;
    relax();
    limit_.assign(pending.size(), kNever);
    critical_.assign(pending.size(), kNobody);
    floor_ = kNever;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const Channel& channel = channels[c];
        if (channel.from == silent) continue;
        const Time time = std::min(channel.base, answers_[c]);
        floor_ = std::min(floor_, time);
        if (time < limit_[channel.to]) {
            limit_[channel.to] = time;
            critical_[channel.to] = c;
        }
    }
}

/// Shortest paths from the EOTs and what is pending: a node whose earliest time fell informs those behind it.
/// Begun with the earliest, hardly a node comes twice.
void Bounds::relax() {
    sort_again(order_, earliest_);
    last_relaxed_.assign(earliest_.size(), kNever);
    answers_.assign(channels_->size(), kNever);
    for (bool changed = true; changed;) {
        changed = false;
        for (const std::size_t n : order_) {
            const Time time = earliest_[n];
            if (time >= last_relaxed_[n] || n == silent_) continue;
            last_relaxed_[n] = time;
            for (const std::size_t c : leaving_[n]) {
                const Channel& channel = (*channels_)[c];
                const Time there = answers_[c] = channel.answer(time);
                if (there >= earliest_[channel.to]) continue;
                earliest_[channel.to] = there;
                changed = true;
            }
        }
    }
}

std::size_t Bounds::root(std::size_t n) const {
    // Walk the critical channels back to the EOT or the pending message that starts the path. A path
    // of equal bounds may close on itself (zero lookaheads); its length is bounded by the number of nodes.
    for (std::size_t steps = 0; steps <= limit_.size(); ++steps) {
        if (critical_[n] == kNobody) return kNobody;
        const Channel& channel = (*channels_)[critical_[n]];
        const std::size_t from = channel.from;
        if (channel.base <= channel.answer(earliest_[from])) return from;
        if ((*pending_)[from] <= limit_[from]) return from;
        n = from;
    }
    return kNobody;
}

std::size_t Bounds::limiter(std::size_t n) const {
    return critical_[n] == kNobody ? kNobody : (*channels_)[critical_[n]].from;
}

std::vector<Time> distances_to(std::size_t target, const std::vector<Channel>& channels, std::size_t nodes) {
    std::vector<Time> distance(nodes, kNever);
    distance[target] = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (const Channel& channel : channels) {
            if (channel.from == target || distance[channel.to] == kNever) continue;
            const Time way = later(distance[channel.to], channel.lookahead);
            if (way < distance[channel.from]) {
                distance[channel.from] = way;
                changed = true;
            }
        }
    }
    return distance;
}

}  // namespace puckloop::cosim
