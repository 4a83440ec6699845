#include "cosim/schedule/bus_turns.h"

#include <algorithm>

namespace puckloop::cosim {

void BusTurns::update(const std::vector<Channel>& channels, std::size_t nodes) {
    const auto used = static_cast<std::size_t>(std::count_if(
        channels.begin(), channels.end(), [](const Channel& channel) { return channel.takes_turns; }));
    if (used == used_ && limit_.size() == nodes) return;
    used_ = used;
    groups_.clear();
    group_of_.assign(nodes, kNobody);
    limit_.assign(nodes, kNever);
    earliest_.assign(nodes, kNever);
    next_send_.assign(nodes, kNever);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        if (!channels[c].takes_turns) continue;
        const std::size_t from = channels[c].from, to = channels[c].to;
        std::size_t group = group_of_[from] == kNobody ? group_of_[to] : group_of_[from];
        if (group == kNobody) {
            group = groups_.size();
            groups_.emplace_back();
        }
        // Two groups that this wire joins become one.
        const std::size_t other = group_of_[to];
        if (other != kNobody && other != group) {
            for (const std::size_t n : groups_[other].nodes)
                group_of_[n] = group;
            Group& joined = groups_[group];
            Group& gone = groups_[other];
            joined.nodes.insert(joined.nodes.end(), gone.nodes.begin(), gone.nodes.end());
            joined.channels.insert(joined.channels.end(), gone.channels.begin(), gone.channels.end());
            gone = {};
        }
        for (const std::size_t n : {from, to}) {
            if (group_of_[n] == group) continue;
            group_of_[n] = group;
            groups_[group].nodes.push_back(n);
        }
        groups_[group].channels.push_back(c);
    }
}

void BusTurns::compute(std::size_t group, const std::vector<Channel>& channels,
                       const std::vector<Time>& heard) {
    const Group& bus = groups_[group];
    for (const std::size_t n : bus.nodes) {
        earliest_[n] = heard[n];
        limit_[n] = next_send_[n] = kNever;
    }
    for (const std::size_t c : bus.channels) {
        const Channel& channel = channels[c];
        next_send_[channel.from] = std::min(next_send_[channel.from], channel.base);
        earliest_[channel.to] = std::min(earliest_[channel.to], channel.base);
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (const std::size_t c : bus.channels) {
            const Channel& channel = channels[c];
            const Time caused = later(earliest_[channel.from], channel.lookahead);
            if (caused >= earliest_[channel.to]) continue;
            earliest_[channel.to] = caused;
            changed = true;
        }
    }
    for (const std::size_t c : bus.channels) {
        const Channel& channel = channels[c];
        const Time time = std::min(channel.base, later(earliest_[channel.from], channel.lookahead));
        limit_[channel.to] = std::min(limit_[channel.to], time);
    }
}

}  // namespace puckloop::cosim
