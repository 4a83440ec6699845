// What the board's /proc/net has of the network, in Linux' forms (net/core/net-procfs.c, net/ipv4/tcp_ipv4.c,
// udp.c, fib_trie.c, arp.c).
//
// Deviations: 1. Of counters packets and octets alone. 2. Users, timers and inodes are 0. 3. Nobody asks for
// addresses, so the table of neighbours is empty.

#include "linuxboard/shim/network/network_stack.h"
#include "linuxboard/shim/network/tcp_states.h"

#include <fmt/format.h>

#include <netinet/in.h>

namespace puckloop::linuxboard {

namespace {

std::string interface_row(const char* name, const InterfaceCounts& counts) {
    return fmt::format(
        "{:>6}: {:7} {:7} {:4} {:4} {:4} {:5} {:10} {:9} {:8} {:7} {:4} {:4} {:4} {:5} {:7} {:10}\n", name,
        counts.octets_received, counts.packets_received, 0, 0, 0, 0, 0, 0, counts.octets_sent,
        counts.packets_sent, 0, 0, 0, 0, 0, 0);
}

std::string end_of_row(Endpoint endpoint) {
    return fmt::format("{:08X}:{:04X}", htonl(endpoint.address), endpoint.port);
}

constexpr const char* kSocketHead =
    "sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode";

}  // namespace

std::string NetworkStack::table(NetworkTable which) const {
    switch (which) {
    case NetworkTable::Interfaces:
        return "Inter-|   Receive                                                |  Transmit\n"
               " face |bytes    packets errs drop fifo frame compressed multicast|bytes    packets errs drop "
               "fifo colls carrier compressed\n" +
               interface_row("lo", loopback_) + interface_row("wlan0", wireless_);
    case NetworkTable::Routes:
        return fmt::format(
            "{:<127}\n{:<127}\n",
            "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT",
            fmt::format("wlan0\t{:08X}\t00000000\t0001\t0\t0\t0\t{:08X}\t0\t0\t0",
                        htonl(place_.address & place_.mask), htonl(place_.mask)));
    case NetworkTable::Neighbours:
        return "IP address       HW type     Flags       HW address            Mask     Device\n";
    case NetworkTable::Streams:
    case NetworkTable::Datagrams:
        break;
    }
    const bool streams = which == NetworkTable::Streams;
    std::string text = fmt::format("{:<{}}\n",
                                   streams ? fmt::format("  {}", kSocketHead)
                                           : fmt::format("   {} ref pointer drops", kSocketHead),
                                   streams ? 149 : 127);
    int row = 0;
    for (const auto& [id, socket] : sockets_) {
        if (socket->stream != streams || socket->echo || socket->netlink || !socket->bound) continue;
        const bool open = socket->tcp || socket->listening || !streams;
        if (!open) continue;
        const int state = socket->listening               ? TCP_LISTEN
                          : socket->tcp                   ? number_of(socket->tcp->state())
                          : streams || !socket->connected ? TCP_CLOSE
                                                          : TCP_ESTABLISHED;
        const Endpoint peer = socket->tcp ? socket->tcp->peer() : socket->peer;
        const std::size_t waiting = socket->listening ? socket->ready.size()
                                    : streams         ? readable(id)
                                                      : socket->queued;
        text += fmt::format(
            "{:<{}}\n",
            fmt::format("{:>{}}: {} {} {:02X} {:08X}:{:08X} 00:00000000 00000000     0        0 0 "
                        "{} 0000000000000000{}",
                        row++, streams ? 4 : 5, end_of_row(socket->local), end_of_row(peer), state,
                        unsent(id), waiting, streams ? 1 : 2, streams ? " 100 0 0 10 0" : " 0"),
            streams ? 149 : 127);
    }
    return text;
}

}  // namespace puckloop::linuxboard
