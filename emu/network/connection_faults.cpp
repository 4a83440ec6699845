#include "emu/network/connection_faults.h"

namespace puckloop::network {

using protocols::IpPacket;
using protocols::kAck;
using protocols::kRst;
using protocols::kSyn;
using protocols::TcpSegment;

namespace {

/// `segment` in place of what `packet` had, on the same way.
cosim::Octets with_segment(IpPacket packet, const TcpSegment& segment) {
    packet.payload = protocols::encode_tcp(segment, packet.from, packet.to);
    return cosim::Octets(protocols::encode(packet));
}

}  // namespace

std::optional<std::pair<IpPacket, TcpSegment>> segment_in(const Passage& sent) {
    auto packet = protocols::decode_ip(sent.octets.view());
    if (!packet || packet->protocol != protocols::kTcp || !packet->whole()) return std::nullopt;
    auto segment = protocols::decode_tcp(*packet);
    if (!segment) return std::nullopt;
    return std::pair(std::move(*packet), std::move(*segment));
}

std::optional<Passage> reset_to_sender(const Passage& sent) {
    const auto read = segment_in(sent);
    if (!read || (read->second.flags & kRst) != 0) return std::nullopt;
    IpPacket answer = read->first;
    std::swap(answer.from, answer.to);
    Passage reset = sent;
    std::swap(reset.from, reset.to);
    reset.arrival += kBehind;
    reset.octets = with_segment(std::move(answer), protocols::reset_for(read->second));
    return reset;
}

ResetConnections::Verdict ResetConnections::look(const Passage& sent, bool counts, std::uint64_t octet) {
    const auto read = segment_in(sent);
    if (!read) return Verdict::Passes;
    const auto& [packet, segment] = *read;
    const Ends ends{packet.from, segment.from_port, packet.to, segment.to_port};
    if ((segment.flags & kSyn) != 0) {
        if ((segment.flags & kAck) == 0) {  // a new connection between the same ports
            dead_.erase(ends);
            dead_.erase({packet.to, segment.to_port, packet.from, segment.from_port});
        }
        Flow& flow = flows_[ends];
        if (flow.first != segment.sequence + 1) flow = {segment.sequence + 1, false};
    }
    if (dead_.contains(ends)) return Verdict::Dead;
    const auto flow = flows_.find(ends);
    if (!counts || flow == flows_.end() || flow->second.reached || segment.data.empty())
        return Verdict::Passes;
    const std::uint32_t before = segment.sequence - flow->second.first;
    if (before + std::uint64_t{segment.data.size()} <= octet) return Verdict::Passes;
    flow->second.reached = true;
    return Verdict::Reaches;
}

std::vector<Passage> ResetConnections::reset(const Passage& sent, std::uint64_t octet) {
    const auto read = segment_in(sent);
    if (!read) return {};
    const auto& [packet, segment] = *read;
    const Ends ends{packet.from, segment.from_port, packet.to, segment.to_port};
    dead_.insert(ends);
    dead_.insert({packet.to, segment.to_port, packet.from, segment.from_port});
    const std::uint64_t before = segment.sequence - flows_.at(ends).first;
    std::vector<Passage> passing;
    TcpSegment kept = segment;
    kept.data.resize(octet > before ? static_cast<std::size_t>(octet - before) : 0);
    if (!kept.data.empty()) {
        kept.flags &= static_cast<protocols::Octet>(~protocols::kFin);
        passing.push_back(sent);
        passing.back().octets = with_segment(packet, kept);
    }
    TcpSegment reset = segment;
    reset.sequence += static_cast<std::uint32_t>(kept.data.size());
    reset.flags = kRst | kAck;
    reset.data.clear();
    passing.push_back(sent);
    passing.back().arrival += kBehind;
    passing.back().octets = with_segment(packet, reset);
    if (const auto back = reset_to_sender(sent)) passing.push_back(*back);
    return passing;
}

bool ClashedAddress::goes_astray(const Passage& sent, double share, cosim::Time cache, RandomStream& random) {
    const auto [belief, is_new] = beliefs_.try_emplace(std::pair(sent.from, sent.to));
    if (is_new || belief->second.until <= sent.start) {
        belief->second.until = cosim::later(sent.start, cache);
        belief->second.wrong = random.uniform() < share;
    }
    return belief->second.wrong;
}

}  // namespace puckloop::network
