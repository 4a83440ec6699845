// Packets of a network, by connection.

#include "protocols/network/ip_packet.h"
#include "traces/decoders/decoders.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

std::string connection_of(const std::string& a, const std::string& b) {
    return fmt::format("{} - {}", std::min(a, b), std::max(a, b));
}

}  // namespace

void decode_packet(const cosim::TraceRow& row, const cosim::Packet& packet, const TakeFrame& take) {
    DecodedFrame frame{packet.start, packet.start + packet.duration, row.link, row.from, "ip", {}, {}};
    const auto read = protocols::decode_ip(packet.octets.view());
    if (!read) {
        frame.text = fmt::format("{} octets", packet.octets.size());
        frame.errors.emplace_back("damaged");
        take(frame);
        return;
    }
    frame.text = protocols::describe(*read);
    std::string from = protocols::to_text(read->from), to = protocols::to_text(read->to), data;
    if (const auto udp = read->protocol == protocols::kUdp && read->whole() ? protocols::decode_udp(*read)
                                                                            : std::nullopt) {
        frame.fields["kind"] = "udp";
        from += fmt::format(":{}", udp->from_port);
        to += fmt::format(":{}", udp->to_port);
        data = udp->data;
    } else if (const auto tcp =
                   read->protocol == protocols::kTcp ? protocols::decode_tcp(*read) : std::nullopt) {
        frame.fields["kind"] = "tcp";
        from += fmt::format(":{}", tcp->from_port);
        to += fmt::format(":{}", tcp->to_port);
        frame.fields["sequence"] = tcp->sequence;
        frame.fields["acknowledged"] = tcp->acknowledged;
        frame.fields["window"] = tcp->window;
        data = tcp->data;
    } else if (read->whole() && read->protocol != protocols::kIcmp) {
        frame.errors.emplace_back("damaged");
    }
    frame.fields["from"] = from;
    frame.fields["to"] = to;
    frame.fields["connection"] = connection_of(from, to);
    frame.fields["data"] = hex_bytes({data.begin(), data.end()});
    take(frame);
}

}  // namespace puckloop::tools
