#include "emu/network/computers.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::network {

using cosim::kNever;
using cosim::Time;
using protocols::IpAddress;

namespace {

constexpr IpAddress kEverybody = 0xffffffff;

std::vector<std::string> names_of(const std::vector<Station>& stations) {
    std::vector<std::string> names;
    for (const Station& station : stations)
        names.push_back(station.name);
    return names;
}

}  // namespace

Computers::Computers(const std::string& medium, int prefix, const std::vector<Station>& stations,
                     std::vector<cosim::CarriedFault> faults)
    : prefix_(prefix), names_(names_of(stations)), faults_(std::move(faults), names_) {
    for (const Station& station : stations) {
        const auto address = protocols::address_of(station.address);
        if (!address)
            throw InputError("", "network " + medium, fmt::format("'{}' is no address", station.address),
                             "such as 10.0.0.1");
        places_.emplace_back().address = *address;
    }
}

std::vector<cosim::Port> Computers::ports() const {
    std::vector<cosim::Port> ports;
    for (const std::string& name : names_)
        ports.push_back({name, cosim::PortKind::Network});
    return ports;
}

bool Computers::is_for_many(IpAddress to) const {
    const IpAddress rest = ~(~IpAddress{0} << (32 - prefix_));
    return to == kEverybody || to >> 28 == 0xe || (to & rest) == rest;
}

bool Computers::is_for(std::size_t computer, IpAddress to) const {
    return places_[computer].address == to || is_for_many(to);
}

void Computers::arrange(const Passage& passage) {
    places_[passage.to].coming.emplace(std::pair(passage.arrival, arrangements_++), passage);
}

void Computers::hand_in(const cosim::Packet& packet, Time arrival) {
    const auto read = protocols::decode_ip(packet.octets.view());
    for (std::size_t c = 0; read && c < places_.size(); ++c)
        if (places_[c].address == read->to)
            arrange({0, c, c, packet.start, packet.duration, arrival, packet.octets});
}

void Computers::deliver(const Passage& sent) {
    if (faults_.empty()) return arrange(sent);
    // Only what was kept back before this one comes behind it.
    std::vector<Passage> held = faults_.take_held(sent.from, sent.to, sent.arrival);
    Passage meant = sent;
    const auto read = protocols::decode_ip(sent.octets.view());
    meant.many = read && is_for_many(read->to);
    for (const Passage& one : faults_.pass(meant))
        arrange(one);
    for (const Passage& one : held)
        arrange(one);
}

void Computers::hand_over(Time until, std::vector<cosim::Message>& outbox) {
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
}

Time Computers::next(std::size_t computer) const {
    const auto& coming = places_[computer].coming;
    const Time next = coming.empty() ? kNever : coming.begin()->first.first;
    return std::min(next, faults_.next_held());
}

nlohmann::ordered_json Computers::report(std::size_t computer) const {
    const ComputerCounts& counts = places_[computer].counts;
    return {{"address", protocols::to_text(places_[computer].address)},
            {"packets_sent", counts.sent},
            {"octets_sent", counts.octets_sent},
            {"packets_received", counts.received},
            {"octets_received", counts.octets_received},
            {"queue_full", counts.queue_full},
            {"for_nobody", counts.nobody}};
}

}  // namespace puckloop::network
