#pragma once
// The computers at a network, as every medium has them: whom a packet is for, what is on its way to each, and
// what faults make of that.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "emu/network/network_faults.h"
#include "protocols/network/ip_packet.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::network {

struct Station {
    std::string name;
    std::string address;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &Station::name, "of the port").required(),
                     field("address", &Station::address, "IPv4").required());
    }
};
static_assert(lists_all_fields<Station>);

struct ComputerCounts {
    std::uint64_t sent = 0, octets_sent = 0;  ///< handed over
    std::uint64_t received = 0, octets_received = 0;
    std::uint64_t queue_full = 0;  ///< dropped
    std::uint64_t nobody = 0;      ///< for an address that nobody has
};

class Computers {
  public:
    /// `medium`: for messages. Throws InputError for what is no address.
    Computers(const std::string& medium, int prefix, const std::vector<Station>& stations,
              std::vector<cosim::CarriedFault> faults);

    std::size_t size() const { return places_.size(); }
    std::vector<cosim::Port> ports() const;
    const std::string& name(std::size_t computer) const { return names_[computer]; }
    ComputerCounts& counts(std::size_t computer) { return places_[computer].counts; }
    NetworkFaults& faults() { return faults_; }

    bool is_for(std::size_t computer, protocols::IpAddress to) const;
    bool is_for_many(protocols::IpAddress to) const;

    /// A packet of the experiment's reaches its computer at `arrival`, whatever the network does.
    void hand_in(const cosim::Packet& packet, cosim::Time arrival);
    /// A packet is to reach a computer, unless a fault is against it. In the order of start for each fault.
    void deliver(const Passage& sent);
    /// Hands on what arrives before `until`.
    void hand_over(cosim::Time until, std::vector<cosim::Message>& outbox);
    /// When the next one arrives, or one that a fault keeps back may; kNever.
    cosim::Time next(std::size_t computer) const;

    /// For the report: address and counters.
    nlohmann::ordered_json report(std::size_t computer) const;

  private:
    struct Place {
        protocols::IpAddress address = 0;
        std::map<std::pair<cosim::Time, std::uint64_t>, Passage> coming;
        ComputerCounts counts;
    };
    void arrange(const Passage& passage);

    int prefix_;
    std::vector<std::string> names_;
    std::vector<Place> places_;
    NetworkFaults faults_;
    std::uint64_t arrangements_ = 0;
};

}  // namespace puckloop::network
