#pragma once
// The network between computers as a node: one port for each, to which its packets go, and "messages" for
// what an event of the scenario sends (linuxboard/shim/network is what makes and takes them). One channel
// that all share carries one packet at a time, in the order in which they were handed over; each arrives a
// fixed time after its last octet was sent.
//
// Deviations: 1. No frames, contention or range of a radio (those: emu/wifi): `mode` perfect or fixed. 2. A
// broadcast takes the channel once and reaches everybody; so does a multicast, and the computers' kernels
// choose.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "cosim/core/seconds_form.h"
#include "emu/network/computers.h"

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::network {

struct NetworkSpec {
    static constexpr std::string_view kKind = "network";

    std::string name = "network";
    int prefix = 24;
    cosim::Time latency = 100 * cosim::kMicrosecond;
    double rate = 0.0;
    std::int64_t queue = 1000;
    std::vector<Station> stations{};
    std::vector<cosim::CarriedFault> faults{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        using S = NetworkSpec;
        return visit(field("name", &S::name, "of the node"),
                     field("prefix", &S::prefix, "bits of the network's part of an address").within(8, 30),
                     field("latency_s", &S::latency, "from a packet's last octet to its arrival")
                         .in("s")
                         .above(0)
                         .as<cosim::Seconds>(),
                     field("rate", &S::rate, "of the channel, bit/s; 0: packets take no time").at_least(0),
                     field("queue", &S::queue, "packets that a computer's interface keeps").at_least(1),
                     field("stations", &S::stations, "the computers").required(), unlisted(&S::faults));
    }
};
static_assert(lists_all_fields<NetworkSpec>);

class NetworkNode : public cosim::Node {
  public:
    /// Throws InputError for what is no address.
    explicit NetworkNode(const NetworkSpec& spec);

    std::string_view name() const override { return spec_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// JSON: "stations": {name: counters}, "busy_s"; with faults "faults" (cosim/faults/fault_json.h).
    std::string finish() override;

  private:
    void take(std::size_t from, const cosim::Packet& packet, cosim::Time now);

    NetworkSpec spec_;
    Computers computers_;
    std::vector<cosim::Port> ports_;
    std::vector<std::deque<cosim::Time>> waiting_;  ///< of each: when its packets' transmissions begin
    std::uint64_t packets_ = 0;
    cosim::Time free_ = 0;  ///< the channel is, from then on
    cosim::Time busy_ = 0;
    cosim::Time granted_ = 0;
};

}  // namespace puckloop::network
