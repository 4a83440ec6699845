// The life of a module's own unicast: looking for a route, sending, waiting for the other end, trying again.

#include "emu/radio/mesh.h"

namespace puckloop::radio {

using cosim::Time;
using protocols::MeshFrame;
using protocols::MeshKind;

void Mesh::start(std::uint64_t token, Time now) {
    Packet& packet = packets_.at(token);
    const auto& routes = stations_[packet.station].routes;
    const auto route = routes.find(packet.frame.target);
    if (route == routes.end()) {
        look_for_route(token, now);
        return;
    }
    ++packet.attempts;
    packet.turn = next_token_++;  // no answer counts before the MAC is done
    MeshFrame frame = packet.frame;
    frame.hop_to = route->second.next;
    submit_at(packet.station, {Purpose::Packet, token, std::move(frame), 0, false}, now);
}

void Mesh::look_for_route(std::uint64_t token, Time now) {
    Packet& packet = packets_.at(token);
    Station& it = stations_[packet.station];
    packet.discovered = true;
    packet.turn = 0;
    if (it.requests.contains(packet.frame.target)) return;
    const RadioSettings& set = settings(packet.station);
    MeshFrame request;
    request.kind = MeshKind::RouteRequest;
    request.radius = set.network_hops;
    request.sequence = it.sequence = static_cast<std::uint16_t>((it.sequence + 1) | 0x8000);
    request.origin = set.address;
    request.target = packet.frame.target;
    const std::uint64_t wait = next_token_++;
    it.requests[packet.frame.target] = wait;
    ++it.counts.discoveries;
    submit_at(packet.station, {Purpose::Copies, 0, std::move(request), set.repeats, false}, now);
    agenda_.add({now + broadcast_time(set) + set.network_hops * one_hop_time(set), EventKind::RouteMissing,
                 packet.station, wait});
}

void Mesh::route_missing(std::size_t station, std::uint64_t wait, Time now) {
    auto& requests = stations_[station].requests;
    for (auto request = requests.begin(); request != requests.end(); ++request) {
        if (request->second != wait) continue;
        const std::uint64_t target = request->first;
        requests.erase(request);
        std::vector<std::uint64_t> waiting;
        for (const auto& [token, packet] : packets_)
            if (packet.station == station && packet.frame.target == target && packet.turn == 0)
                waiting.push_back(token);
        for (const std::uint64_t token : waiting)
            end(token, kNoRoute, now);
        return;
    }
}

void Mesh::lost(std::uint64_t token, std::uint8_t delivery, Time now) {
    Packet& packet = packets_.at(token);
    const int most = 1 + settings(packet.station).network_retries;
    const bool broken = delivery == kNoMacAck;
    if (!broken && packet.attempts < most) {
        ++packet.retries;
        ++stations_[packet.station].counts.retries;
        start(token, now);
        return;
    }
    // Manual, "Transmitting a unicast with a broken route": the route is looked for once more.
    stations_[packet.station].routes.erase(packet.frame.target);
    if (packet.looked_again || settings(packet.station).network_retries == 0) {
        end(token, delivery, now);
        return;
    }
    packet.looked_again = true;
    packet.attempts = 0;
    ++packet.retries;
    ++stations_[packet.station].counts.retries;
    look_for_route(token, now);
}

void Mesh::end(std::uint64_t token, std::uint8_t delivery, Time now) {
    const auto node = packets_.extract(token);
    const Packet& packet = node.mapped();
    MeshCounts& counts = stations_[packet.station].counts;
    ++(delivery == kDelivered ? counts.delivered : counts.undelivered);
    user_.report(packet.station,
                 {packet.frame.sequence, packet.retries, delivery,
                  packet.discovered ? kRouteDiscovered : std::uint8_t{0}},
                 now);
}

}  // namespace puckloop::radio
