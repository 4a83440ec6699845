// Packets as they come to a board: each input is one or several of them, each with a length before it.

#include "linuxboard/shim/network/network_stack.h"
#include "tests/fuzz/target.h"

#include <cerrno>

void puckloop::fuzz::run_input(Input input) {
    using namespace linuxboard;
    NetworkStack stack({"10.0.0.1", 24, {{"a", "10.0.0.1"}, {"b", "10.0.0.2"}}}, RandomStream(1, "fuzz"));
    const int listener = stack.open(true), datagrams = stack.open(false), client = stack.open(true);
    require(stack.bind(listener, {0, 7000}) == 0 && stack.listen(listener, 2) == 0, "it listens");
    require(stack.bind(datagrams, {0, 5000}) == 0, "it has a port");
    require(stack.connect(client, {0x0a000002, 80}, 0) == EINPROGRESS, "it connects");
    cosim::Time now = 0;
    while (input.size() > 1) {
        const std::size_t size = std::min<std::size_t>(256u * (input[0] & 7u) + input[1], input.size() - 2);
        std::vector<std::uint8_t> octets(input.begin() + 2, input.begin() + 2 + static_cast<long>(size));
        input = input.subspan(2 + size);
        now += cosim::kMillisecond;
        stack.receive_packet(octets, now);
        // Few mutations keep a checksum: the same packet is also read with right ones.
        if (auto packet = protocols::decode_ip(octets)) {
            if (const auto udp = protocols::decode_udp(*packet)) {
                packet->payload = protocols::encode_udp(*udp, packet->from, packet->to);
                require(protocols::decode_udp(*packet)->data == udp->data, "a datagram comes back");
            }
            require(!protocols::describe(*packet).empty(), "there is something to say");
        } else if (octets.size() >= protocols::kIpHeader + protocols::kTcpHeader) {
            const auto word = [&](std::size_t at) {
                std::uint32_t value = 0;
                for (std::size_t i = 0; i < 4; ++i)
                    value = value << 8 | octets[at + i];
                return value;
            };
            protocols::TcpSegment segment;
            segment.from_port = static_cast<std::uint16_t>(word(18));
            segment.to_port = (octets[22] & 1) != 0 ? 7000 : static_cast<std::uint16_t>(word(20));
            segment.sequence = word(24);
            segment.acknowledged = word(28);
            segment.flags = octets[33];
            segment.window = static_cast<std::uint16_t>(word(32));
            segment.data.assign(octets.begin() + 40, octets.end());
            packet.emplace();
            packet->from = 0x0a000002;
            packet->to = 0x0a000001;
            packet->protocol = protocols::kTcp;
            packet->payload = protocols::encode_tcp(segment, packet->from, packet->to);
            const auto whole = protocols::encode(*packet);
            stack.receive_packet(whole, now);
        }
        stack.advance(now);
        stack.take_packets();
        NetworkStack::Received received;
        stack.receive(datagrams, 2000, false, received, now);
        const int accepted = stack.accept(listener);
        if (accepted < 0) continue;
        stack.receive(accepted, 100, false, received, now);
        stack.close(accepted, now);
    }
    stack.close_all(now);
}
