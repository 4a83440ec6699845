// Ports and addresses of sockets.

#include "linuxboard/shim/network/network_stack.h"

#include "protocols/network/dns_message.h"

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using protocols::IpAddress;

namespace {
constexpr std::uint16_t kFirstFreePort = 32'768;
constexpr int kFreePorts = 28'232;
}  // namespace

/// Another socket has the endpoint, and one of the two does not share it.
bool NetworkStack::is_taken(const Socket& socket, Endpoint endpoint) const {
    return std::any_of(sockets_.begin(), sockets_.end(), [&](const auto& entry) {
        const Socket& other = *entry.second;
        if (&other == &socket || other.stream != socket.stream || other.echo != socket.echo || !other.bound)
            return false;
        if (other.local.port != endpoint.port) return false;
        const bool overlap =
            other.local.address == 0 || endpoint.address == 0 || other.local.address == endpoint.address;
        if (!overlap) return false;
        if (socket.options.reuse_port && other.options.reuse_port) return false;
        const bool share = socket.options.reuse_address && other.options.reuse_address;
        return !(share && !(socket.stream && other.listening));
    });
}

/// Bound to the board alone, and for another one.
bool NetworkStack::leaves_loopback(const Socket& socket, IpAddress to) const {
    return socket.local.address >> 24 == kLocalHost >> 24 && !is_own(to);
}

/// Which of `count` sockets that share an endpoint (SO_REUSEPORT) gets what comes from `there`. FNV-1a; Linux
/// takes a hash with a number that it draws when it starts.
std::size_t NetworkStack::share_of(Endpoint here, Endpoint there, std::size_t count) {
    if (count == 1) return 0;
    std::uint32_t hash = 0x811c9dc5;
    for (const std::uint32_t word :
         {here.address, std::uint32_t{here.port}, there.address, std::uint32_t{there.port}})
        for (int shift = 0; shift < 32; shift += 8)
            hash = (hash ^ (word >> shift & 0xff)) * 0x01000193;
    hash = (hash ^ hash >> 15) * 0x2c1b3c6d;  // its low bits are those of the octets
    return (hash ^ hash >> 12) % count;
}

int NetworkStack::bind(int id, Endpoint to) {
    Socket& socket = at(id);
    if (socket.netlink) {
        bind_netlink(socket, to.address);
        return 0;
    }
    if (socket.bound || socket.connected) return EINVAL;
    const bool for_many = !socket.stream && is_for_many(to.address);
    if (to.address != 0 && !is_own(to.address) && !for_many) return EADDRNOTAVAIL;
    if (to.port == 0) return bind_somewhere(socket, to.address);
    if (is_taken(socket, to)) return EADDRINUSE;
    if (!socket.stream && to == Endpoint{kResolver, protocols::kDnsPort}) return EADDRINUSE;
    socket.local = to;
    socket.bound = true;
    return 0;
}

int NetworkStack::bind_somewhere(Socket& socket, IpAddress address) {
    for (int tries = 0; tries < kFreePorts; ++tries) {
        const Endpoint one{address, next_port_};
        next_port_ = next_port_ + 1 < kFirstFreePort + kFreePorts ? static_cast<std::uint16_t>(next_port_ + 1)
                                                                  : kFirstFreePort;
        const bool used = std::any_of(sockets_.begin(), sockets_.end(), [&](const auto& entry) {
            return entry.second->stream == socket.stream && entry.second->echo == socket.echo &&
                   entry.second->local.port == one.port;
        });
        if (used) continue;
        socket.local = one;
        socket.bound = true;
        return 0;
    }
    return EADDRINUSE;
}

}  // namespace puckloop::linuxboard
