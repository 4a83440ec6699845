#include "emu/network/network_node.h"

#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace puckloop::network {

using cosim::kNever;
using cosim::Time;
using protocols::IpAddress;

namespace {

constexpr IpAddress kEverybody = 0xffffffff;

std::vector<std::string> names_of(const NetworkSpec& spec) {
    std::vector<std::string> names;
    for (const Station& station : spec.stations)
        names.push_back(station.name);
    return names;
}

/// 0 at a rate of 0.
Time air_time(std::size_t octets, double rate) {
    if (rate == 0) return 0;
    return std::llround(8.0 * static_cast<double>(octets) / rate * static_cast<double>(cosim::kSecond));
}

}  // namespace

NetworkNode::NetworkNode(const NetworkSpec& spec) : spec_(spec), faults_(spec.faults, names_of(spec)) {
    for (const Station& station : spec.stations) {
        const auto address = protocols::address_of(station.address);
        if (!address)
            throw InputError("", "network " + spec.name, fmt::format("'{}' is no address", station.address),
                             "such as 10.0.0.1");
        ports_.push_back({station.name, cosim::PortKind::Network});
        places_.emplace_back().address = *address;
    }
}

bool NetworkNode::is_for_many(IpAddress to) const {
    const IpAddress rest = ~(~IpAddress{0} << (32 - spec_.prefix));
    return to == kEverybody || to >> 28 == 0xe || (to & rest) == rest;
}

bool NetworkNode::is_for(std::size_t place, IpAddress to) const {
    return places_[place].address == to || is_for_many(to);
}

void NetworkNode::arrange(const Passage& passage) {
    places_[passage.to].coming.emplace(std::pair(passage.arrival, arrangements_++), passage);
}

void NetworkNode::take(std::size_t from, const cosim::Packet& packet, Time now) {
    Place& sender = places_[from];
    const auto read = protocols::decode_ip(packet.octets.view());
    if (!read) return;
    ++sender.counts.sent;
    sender.counts.octets_sent += packet.octets.size();
    while (!sender.waiting.empty() && sender.waiting.front() <= now)
        sender.waiting.pop_front();
    if (static_cast<std::int64_t>(sender.waiting.size()) >= spec_.queue) {
        ++sender.counts.queue_full;
        return;
    }
    const std::uint64_t number = packets_++;
    const Time start = std::max(now, free_);
    const Time duration = air_time(packet.octets.size(), faults_.rate(spec_.rate, start, from, number));
    free_ = start + duration;
    busy_ += duration;
    if (start > now) sender.waiting.push_back(start);
    bool somebody = false;
    for (std::size_t to = 0; to < places_.size(); ++to) {
        if (to == from || !is_for(to, read->to)) continue;
        somebody = true;
        const Passage sent{number, from, to, start, duration, free_ + spec_.latency, packet.octets};
        if (faults_.empty()) {
            arrange(sent);
            continue;
        }
        // Only what was kept back before this one comes behind it.
        std::vector<Passage> held = faults_.take_held(from, to, sent.arrival);
        for (const Passage& one : faults_.pass(sent))
            arrange(one);
        for (const Passage& one : held)
            arrange(one);
    }
    if (!somebody) ++sender.counts.nobody;
}

void NetworkNode::advance(Time until, std::span<const cosim::Message> inbox,
                          std::vector<cosim::Message>& outbox) {
    for (const cosim::Message& message : inbox)
        if (const auto* packet = std::get_if<cosim::Packet>(&message.payload))
            if (message.port < places_.size()) take(message.port, *packet, message.time);
    for (const Passage& one : faults_.take_held_before(until))
        arrange(one);
    for (std::size_t p = 0; p < places_.size(); ++p) {
        Place& place = places_[p];
        while (!place.coming.empty() && place.coming.begin()->first.first < until) {
            const auto& [key, passage] = *place.coming.begin();
            ++place.counts.received;
            place.counts.octets_received += passage.octets.size();
            outbox.push_back({key.first, static_cast<cosim::PortIndex>(p),
                              cosim::Packet{passage.start, passage.duration, passage.octets}});
            place.coming.erase(place.coming.begin());
        }
    }
    granted_ = until;
}

Time NetworkNode::earliest_output(cosim::PortIndex port) const {
    const auto& coming = places_[port].coming;
    const Time next = coming.empty() ? kNever : coming.begin()->first.first;
    return std::max(granted_, std::min(next, faults_.next_held()));
}

Time NetworkNode::lookahead(cosim::PortIndex /*port*/) const {
    return spec_.latency + air_time(cosim::kFewestPacketOctets, spec_.rate);
}

std::string NetworkNode::finish() {
    using nlohmann::ordered_json;
    ordered_json stations = ordered_json::object();
    for (std::size_t p = 0; p < places_.size(); ++p) {
        const Counts& counts = places_[p].counts;
        stations[ports_[p].name] = {{"address", protocols::to_text(places_[p].address)},
                                    {"packets_sent", counts.sent},
                                    {"octets_sent", counts.octets_sent},
                                    {"packets_received", counts.received},
                                    {"octets_received", counts.octets_received},
                                    {"queue_full", counts.queue_full},
                                    {"for_nobody", counts.nobody}};
    }
    ordered_json report{{"stations", std::move(stations)}, {"busy_s", cosim::to_seconds(busy_)}};
    if (!faults_.empty()) report["faults"] = cosim::fault_results(faults_.carried(), granted_);
    return report.dump();
}

}  // namespace puckloop::network
