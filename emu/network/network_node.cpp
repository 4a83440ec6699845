#include "emu/network/network_node.h"

#include "base/json.h"

#include <algorithm>
#include <cmath>

namespace puckloop::network {

using cosim::Time;

namespace {

/// 0 at a rate of 0.
Time air_time(std::size_t octets, double rate) {
    if (rate == 0) return 0;
    return std::llround(8.0 * static_cast<double>(octets) / rate * static_cast<double>(cosim::kSecond));
}

}  // namespace

NetworkNode::NetworkNode(const NetworkSpec& spec)
    : spec_(spec),
      computers_(spec.name, spec.prefix, spec.stations, spec.faults),
      ports_(computers_.ports()),
      waiting_(ports_.size()) {
    ports_.push_back({"messages", cosim::PortKind::Network});
}

void NetworkNode::take(std::size_t from, const cosim::Packet& packet, Time now) {
    ComputerCounts& counts = computers_.counts(from);
    std::deque<Time>& waiting = waiting_[from];
    const auto read = protocols::decode_ip(packet.octets.view());
    if (!read) return;
    ++counts.sent;
    counts.octets_sent += packet.octets.size();
    while (!waiting.empty() && waiting.front() <= now)
        waiting.pop_front();
    if (static_cast<std::int64_t>(waiting.size()) >= spec_.queue) {
        ++counts.queue_full;
        return;
    }
    const std::uint64_t number = packets_++;
    const Time start = std::max(now, free_);
    const Time duration =
        air_time(packet.octets.size(), computers_.faults().rate(spec_.rate, start, from, number));
    free_ = start + duration;
    busy_ += duration;
    if (start > now) waiting.push_back(start);
    bool somebody = false;
    for (std::size_t to = 0; to < computers_.size(); ++to) {
        if (to == from || !computers_.is_for(to, read->to)) continue;
        somebody = true;
        computers_.deliver({number, from, to, start, duration, free_ + spec_.latency, packet.octets});
    }
    if (!somebody) ++counts.nobody;
}

void NetworkNode::advance(Time until, std::span<const cosim::Message> inbox,
                          std::vector<cosim::Message>& outbox) {
    for (const cosim::Message& message : inbox) {
        const auto* packet = std::get_if<cosim::Packet>(&message.payload);
        if (packet == nullptr) continue;
        if (message.port < computers_.size())
            take(message.port, *packet, message.time);
        else
            computers_.hand_in(*packet, message.time + lookahead(message.port));
    }
    computers_.hand_over(until, outbox);
    granted_ = until;
}

Time NetworkNode::earliest_output(cosim::PortIndex port) const {
    if (port >= computers_.size()) return cosim::kNever;
    return std::max(granted_, computers_.next(port));
}

Time NetworkNode::lookahead(cosim::PortIndex /*port*/) const {
    return spec_.latency + air_time(cosim::kFewestPacketOctets, spec_.rate);
}

std::string NetworkNode::finish() {
    using nlohmann::ordered_json;
    ordered_json stations = ordered_json::object();
    for (std::size_t p = 0; p < computers_.size(); ++p)
        stations[ports_[p].name] = computers_.report(p);
    ordered_json report{{"stations", std::move(stations)}, {"busy_s", cosim::to_seconds(busy_)}};
    const NetworkFaults& faults = computers_.faults();
    if (!faults.empty()) report["faults"] = cosim::fault_results(faults.carried(), granted_);
    return report.dump();
}

}  // namespace puckloop::network
