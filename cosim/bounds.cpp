#include "cosim/bounds.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {
Time bound(const Channel& channel, const std::vector<Time>& earliest) {
    return std::min(channel.base, later(earliest[channel.from], channel.reaction));
}
}  // namespace

void Bounds::compute(const std::vector<Channel>& channels, const std::vector<Time>& pending,
                     std::size_t silent) {
    channels_ = channels;
    if (silent != kNobody)
        std::erase_if(channels_, [silent](const Channel& channel) { return channel.from == silent; });
    pending_ = pending;
    earliest_ = pending;
    // Reactions are not negative, so a shortest path has no more channels than there are nodes.
    for (bool changed = true; changed;) {
        changed = false;
        for (const Channel& channel : channels_) {
            const Time time = bound(channel, earliest_);
            if (time < earliest_[channel.to]) {
                earliest_[channel.to] = time;
                changed = true;
            }
        }
    }
    limit_.assign(pending.size(), kNever);
    critical_.assign(pending.size(), kNobody);
    floor_ = kNever;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const Time time = bound(channels_[c], earliest_);
        floor_ = std::min(floor_, time);
        if (time < limit_[channels_[c].to]) {
            limit_[channels_[c].to] = time;
            critical_[channels_[c].to] = c;
        }
    }
}

std::size_t Bounds::root(std::size_t n) const {
    // Walk the critical channels back to the promise or the pending message that starts the path. A path
    // of equal bounds may close on itself (zero reactions); its length is bounded by the number of nodes.
    for (std::size_t steps = 0; steps <= limit_.size(); ++steps) {
        if (critical_[n] == kNobody) return kNobody;
        const Channel& channel = channels_[critical_[n]];
        const std::size_t from = channel.from;
        if (channel.base <= later(earliest_[from], channel.reaction)) return from;
        if (pending_[from] <= limit_[from]) return from;
        n = from;
    }
    return kNobody;
}

std::size_t Bounds::limiter(std::size_t n) const {
    return critical_[n] == kNobody ? kNobody : channels_[critical_[n]].from;
}

std::vector<Time> distances_to(std::size_t target, const std::vector<Channel>& channels, std::size_t nodes) {
    std::vector<Time> distance(nodes, kNever);
    distance[target] = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (const Channel& channel : channels) {
            if (channel.from == target || distance[channel.to] == kNever) continue;
            const Time way = later(distance[channel.to], channel.reaction);
            if (way < distance[channel.from]) {
                distance[channel.from] = way;
                changed = true;
            }
        }
    }
    return distance;
}

}  // namespace puckloop::cosim
