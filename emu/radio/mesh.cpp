#include "emu/radio/mesh.h"

#include <algorithm>

namespace puckloop::radio {

using cosim::Time;
using protocols::kXBeeBroadcast;
using protocols::MeshFrame;
using protocols::MeshKind;

namespace {

constexpr Time kDelaySlot = 18 * cosim::kMillisecond;  // manual, "Transmitting a broadcast"
// Backoff of 7 units, turnaround, the longest frame, waiting for its acknowledgement.
constexpr Time kAttempt = 7 * 20 * kSymbol + kTurnaround + air_time(127) + kAckWait;
constexpr int kAssumedRetries = 3;
constexpr std::size_t kMostSeen = 64;
constexpr std::uint8_t kNoAcknowledgement = 0x01;  // XBeeTx::options

}  // namespace

Time one_hop_time(const RadioSettings& settings) {
    return (1 + std::min<int>(settings.mac_retries, kAssumedRetries)) * kAttempt;
}

Time broadcast_time(const RadioSettings& settings) {
    return Time{settings.delay_slots} * settings.network_hops * (settings.repeats + 1) * kDelaySlot;
}

Time known_route_time(const RadioSettings& settings) {
    return 2 * Time{settings.network_hops} * one_hop_time(settings);
}

Mesh::Mesh(Medium& medium, const std::vector<std::string>& names, std::uint64_t seed, Time processing,
           AirFaults& faults, MeshUser& user)
    : processing_(processing), user_(user), mac_(medium, agenda_, names, seed, faults, *this) {
    for (const std::string& name : names)
        stations_.emplace_back(RandomStream(seed, "radio/delays/" + name));
}

void Mesh::set(std::size_t station, const RadioSettings& settings, Time now) {
    const RadioSettings before = mac_.settings(station);
    const bool same = before.on && settings.on && before.channel == settings.channel &&
                      before.pan == settings.pan && before.address == settings.address;
    const std::vector<std::uint64_t> dropped = mac_.set(station, settings);
    if (same) return;
    // What the module waited for is of a life before.
    std::erase_if(packets_, [station](const auto& one) { return one.second.station == station; });
    stations_[station].routes.clear();
    stations_[station].requests.clear();
    stations_[station].seen.clear();
    if (!settings.on) {
        std::erase_if(jobs_, [station](const auto& one) { return one.second.station == station; });
        return;
    }
    for (const std::uint64_t token : dropped)
        drop(station, token, now);
}

/// A frame that the MAC forgot though its module goes on. Its own broadcast is still repeated and reported:
/// not before anything that a module's message leads to (lookahead()).
void Mesh::drop(std::size_t station, std::uint64_t token, Time now) {
    const auto job = jobs_.find(token);
    if (job == jobs_.end()) return;
    if (job->second.purpose == Purpose::Copies) {
        agenda_.add({now + lookahead(), EventKind::Dropped, station, token});
        return;
    }
    if (job->second.purpose == Purpose::Relay) ++stations_[station].counts.no_way_on;
    jobs_.erase(job);
}

void Mesh::send(std::size_t station, const MeshFrame& frame, Time now) {
    if (!settings(station).on) return;
    MeshFrame own = frame;
    own.hops = 0;
    own.origin = settings(station).address;
    const auto most = settings(station).network_hops;
    if (own.broadcast()) {
        ++stations_[station].counts.broadcasts;
        own.radius = own.radius == 0 ? most : std::min(own.radius, most);
        Job job{Purpose::Copies, 0, own, settings(station).repeats, true};
        seen_before(station, own);
        submit_at(station, std::move(job), now);
        return;
    }
    ++stations_[station].counts.unicasts;
    own.radius = most;
    const std::uint64_t token = next_token_++;
    packets_.emplace(token, Packet{station, std::move(own)});
    start(token, now);
}

void Mesh::run(Time until, bool inclusive) {
    while (agenda_.next() < until || (inclusive && agenda_.next() == until)) {
        if (agenda_.empty()) return;
        happen(agenda_.take());
    }
}

Time Mesh::earliest_output() const {
    Time earliest = cosim::kNever;
    for (const auto& [key, event] : agenda_.events()) {
        if (event.at >= earliest) break;
        const bool to_mac = event.kind == EventKind::Submit || event.kind == EventKind::Repeat;
        earliest = std::min(earliest, to_mac ? event.at + lookahead() : Mac::earliest_end(event));
    }
    return earliest;
}

void Mesh::happen(const Event& event) {
    switch (event.kind) {
    case EventKind::Submit:
    case EventKind::Repeat:
        submit(event.station, event.token, event.at);
        break;
    case EventKind::Dropped:
        sent(event.station, event.token, false, false, event.at);
        break;
    case EventKind::RouteMissing:
        route_missing(event.station, event.token, event.at);
        break;
    case EventKind::NetworkAckMissing:
        // The token is the packet's turn; turns are unique.
        for (auto& [token, packet] : packets_)
            if (packet.turn == event.token) {
                lost(token, kNoNetworkAck, event.at);
                break;
            }
        break;
    default:
        mac_.happen(event);
    }
}

void Mesh::submit_at(std::size_t station, Job job, Time at) {
    const std::uint64_t token = next_token_++;
    job.station = station;
    jobs_.emplace(token, std::move(job));
    agenda_.add({at, EventKind::Submit, station, token});
}

void Mesh::submit(std::size_t station, std::uint64_t token, Time now) {
    const auto job = jobs_.find(token);
    if (job == jobs_.end()) return;
    if (!settings(station).on) {
        jobs_.erase(job);
        return;
    }
    mac_.submit(station, job->second.frame, token, now);
}

void Mesh::sent(std::size_t station, std::uint64_t token, bool delivered, bool busy, Time now) {
    const auto found = jobs_.find(token);
    if (found == jobs_.end()) return;
    Job& job = found->second;
    if (job.purpose == Purpose::Copies) {
        if (job.copies > 0 && settings(station).on) {
            --job.copies;
            agenda_.add({now + random_delay(station), EventKind::Repeat, station, token});
            return;
        }
        if (job.reports) user_.report(station, {job.frame.sequence, 0, kDelivered, 0}, now);
    } else if (job.purpose == Purpose::Packet) {
        const auto packet = packets_.find(job.packet);
        if (packet == packets_.end()) {
            // Its module was reset, or its acknowledgement came before the MAC's.
        } else if (!delivered) {
            lost(job.packet, busy ? kChannelBusy : kNoMacAck, now);
        } else if (settings(station).network_retries == 0 ||
                   (packet->second.frame.options & kNoAcknowledgement)) {
            end(job.packet, kDelivered, now);
        } else {
            packet->second.turn = next_token_++;
            agenda_.add({now + known_route_time(settings(station)), EventKind::NetworkAckMissing, station,
                         packet->second.turn});
        }
    } else if (job.purpose == Purpose::Relay && !delivered) {
        ++stations_[station].counts.no_way_on;
        stations_[station].routes.erase(job.frame.target);
    }
    jobs_.erase(token);
}

Time Mesh::random_delay(std::size_t station) {
    const auto most = static_cast<std::uint64_t>(settings(station).delay_slots * kDelaySlot);
    return static_cast<Time>(stations_[station].delays.below(most + 1));
}

bool Mesh::seen_before(std::size_t station, const MeshFrame& frame) {
    auto& seen = stations_[station].seen;
    const std::pair key(frame.origin, frame.sequence);
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) return true;
    seen.push_back(key);
    if (seen.size() > kMostSeen) seen.pop_front();
    return false;
}

void Mesh::received(std::size_t station, const MeshFrame& frame, const Heard& heard) {
    if (frame.hop_to == kXBeeBroadcast)
        heard_broadcast(station, frame, heard);
    else
        heard_unicast(station, frame, heard);
}

void Mesh::heard_broadcast(std::size_t station, const MeshFrame& frame, const Heard& heard) {
    Station& it = stations_[station];
    if (frame.origin == settings(station).address && frame.kind == MeshKind::RouteRequest) return;
    if (seen_before(station, frame)) {
        ++it.counts.duplicates;
        return;
    }
    if (frame.kind == MeshKind::RouteRequest) {
        learn(station, frame.origin, {frame.hop_from, static_cast<std::uint8_t>(frame.hops + 1)});
        if (frame.target == settings(station).address) {
            answer(station, frame, MeshKind::RouteReply, heard.end + processing_);
            return;
        }
    } else {
        user_.deliver(station, frame, heard);
    }
    if (frame.radius <= 1) return;
    MeshFrame on = frame;
    ++on.hops;
    --on.radius;
    ++it.counts.relayed;
    submit_at(station, {Purpose::Copies, 0, std::move(on), settings(station).repeats, false},
              heard.end + processing_ + random_delay(station));
}

void Mesh::heard_unicast(std::size_t station, const MeshFrame& frame, const Heard& heard) {
    // A reply leaves the way to where it comes from; so does everything else that comes along.
    learn(station, frame.origin, {frame.hop_from, static_cast<std::uint8_t>(frame.hops + 1)});
    if (frame.target == settings(station).address) {
        arrived(station, frame, heard);
        return;
    }
    Station& it = stations_[station];
    const auto route = it.routes.find(frame.target);
    if (route == it.routes.end() || frame.radius <= 1) {
        ++it.counts.no_way_on;
        return;
    }
    MeshFrame on = frame;
    ++on.hops;
    --on.radius;
    on.hop_to = route->second.next;
    ++it.counts.relayed;
    submit_at(station, {Purpose::Relay, 0, std::move(on), 0, false}, heard.end + processing_);
}

void Mesh::arrived(std::size_t station, const MeshFrame& frame, const Heard& heard) {
    if (frame.kind == MeshKind::RouteReply) {
        auto& requests = stations_[station].requests;
        requests.erase(frame.origin);
        std::vector<std::uint64_t> waiting;
        for (const auto& [token, packet] : packets_)
            if (packet.station == station && packet.frame.target == frame.origin && packet.turn == 0)
                waiting.push_back(token);
        for (const std::uint64_t token : waiting)
            start(token, heard.end + processing_);
        return;
    }
    if (frame.kind == MeshKind::Acknowledge) {
        for (const auto& [token, packet] : packets_)
            if (packet.station == station && packet.frame.sequence == frame.sequence &&
                packet.frame.target == frame.origin) {
                end(token, kDelivered, heard.end);
                return;
            }
        return;
    }
    if ((frame.options & kNoAcknowledgement) == 0)
        answer(station, frame, MeshKind::Acknowledge, heard.end + processing_);
    if (seen_before(station, frame)) {
        ++stations_[station].counts.duplicates;
        return;
    }
    ++hops_[std::min<std::size_t>(frame.hops, kHopClasses - 1)];
    user_.deliver(station, frame, heard);
}

void Mesh::answer(std::size_t station, const MeshFrame& frame, MeshKind kind, Time now) {
    Station& it = stations_[station];
    const auto route = it.routes.find(frame.origin);
    if (route == it.routes.end()) return;
    MeshFrame back;
    back.kind = kind;
    back.options = kNoAcknowledgement;
    back.radius = settings(station).network_hops;
    back.sequence = frame.sequence;
    back.origin = settings(station).address;
    back.target = frame.origin;
    back.hop_to = route->second.next;
    submit_at(station, {Purpose::Own, 0, std::move(back), 0, false}, now);
}

void Mesh::learn(std::size_t station, std::uint64_t target, const Route& route) {
    if (target != settings(station).address) stations_[station].routes[target] = route;
}

}  // namespace puckloop::radio
