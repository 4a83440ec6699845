#pragma once
// Packets for the network's node, and what it hands on.

#include "emu/network/network_node.h"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace puckloop::tests {

inline constexpr protocols::IpAddress kFirst = 0x0a000001, kEverybody = 0xffffffff;

/// Three computers, a b c.
inline network::NetworkSpec three(cosim::Time latency, double rate = 0) {
    network::NetworkSpec spec;
    spec.latency = latency;
    spec.rate = rate;
    spec.stations = {{"a", "10.0.0.1"}, {"b", "10.0.0.2"}, {"c", "10.0.0.3"}};
    return spec;
}

/// `size` octets in all, from computer number `from`; the text is in it.
inline cosim::Message packet(cosim::Time time, std::size_t from, protocols::IpAddress to,
                             const std::string& text, std::size_t size = 100) {
    protocols::IpPacket packet;
    packet.from = kFirst + static_cast<protocols::IpAddress>(from);
    packet.to = to;
    packet.protocol = protocols::kUdp;
    std::string data = text;
    data.resize(size - protocols::kIpHeader - protocols::kUdpHeader);
    packet.payload = protocols::encode_udp({1, 2, data}, packet.from, packet.to);
    return {time, static_cast<cosim::PortIndex>(from),
            cosim::Packet{time, 0, cosim::Octets(protocols::encode(packet))}};
}

/// "1.5 ms b one": when what reached whom; texts of damaged packets are "?".
inline std::vector<std::string> arrived(const std::vector<cosim::Message>& outbox) {
    std::vector<std::string> lines;
    for (const cosim::Message& message : outbox) {
        const auto& one = std::get<cosim::Packet>(message.payload);
        const auto read = protocols::decode_ip(one.octets.view());
        const auto udp = read ? protocols::decode_udp(*read) : std::nullopt;
        const std::string text = udp ? std::string(udp->data.c_str()) : "?";
        lines.push_back(
            fmt::format("{} us {} {}", message.time / cosim::kMicrosecond, "abc"[message.port], text));
    }
    return lines;
}

/// The same however time is granted: all at once, and in steps.
inline std::vector<std::string> carried(const network::NetworkSpec& spec,
                                        const std::vector<cosim::Message>& sent, cosim::Time end,
                                        cosim::Time step) {
    network::NetworkNode node(spec);
    std::vector<cosim::Message> outbox;
    std::size_t next = 0;
    for (cosim::Time until = step; until <= end; until += step) {
        std::vector<cosim::Message> inbox;
        while (next < sent.size() && sent[next].time < until)
            inbox.push_back(sent[next++]);
        node.advance(until, inbox, outbox);
    }
    std::stable_sort(outbox.begin(), outbox.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    return arrived(outbox);
}

}  // namespace puckloop::tests
