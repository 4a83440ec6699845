#pragma once
// How a Linux board is on a network: its address, and the names of all computers there.

#include "base/fields/field.h"
#include "protocols/network/ip_packet.h"

#include <bit>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::linuxboard {

struct NetworkName {
    std::string name;
    std::string address;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &NetworkName::name, "of a computer").required(),
                     field("address", &NetworkName::address, "its IPv4 address").required());
    }
};
static_assert(lists_all_fields<NetworkName>);

struct NetworkSpec {
    std::string address;
    int prefix = 24;
    std::vector<NetworkName> names;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("address", &NetworkSpec::address, "of the board").required(),
                     field("prefix", &NetworkSpec::prefix, "bits of the network's part").within(8, 30),
                     field("names", &NetworkSpec::names, "as in /etc/hosts, the board's own among them"));
    }
};
static_assert(lists_all_fields<NetworkSpec>);

/// The spec as numbers.
struct NetworkPlace {
    protocols::IpAddress address = 0, mask = 0;

    bool contains(protocols::IpAddress other) const { return (other & mask) == (address & mask); }
    protocols::IpAddress broadcast() const { return address | ~mask; }
    int prefix() const { return std::popcount(mask); }
};
/// Throws InputError for what is no address.
NetworkPlace place_of(const NetworkSpec& spec);

}  // namespace puckloop::linuxboard
