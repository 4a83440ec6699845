#pragma once
// Faults of the network: packets that a computer does not receive, or other than they were sent. Kinds and
// parameters: cosim/faults/kinds/network_kinds.cpp.

#include "base/random.h"
#include "cosim/core/message.h"
#include "cosim/faults/fault_json.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::network {

/// A packet on its way to one computer.
struct Passage {
    std::uint64_t number = 0;  ///< of the packet in the run, from 0
    std::size_t from = 0, to = 0;
    cosim::Time start = 0;     ///< its transmission begins
    cosim::Time duration = 0;  ///< of that
    cosim::Time arrival = 0;   ///< if nothing happens to it
    cosim::Octets octets{};
};

class NetworkFaults {
  public:
    /// `names`: the computers. Throws InputError for one that is not there.
    NetworkFaults(std::vector<cosim::CarriedFault> faults, std::vector<std::string> names);

    bool empty() const { return carried_.empty(); }
    const std::vector<cosim::CarriedFault>& carried() const { return carried_; }

    /// What the network carries at most from `time` on, bit/s; `rate` without a fault, 0: without limit.
    double rate(double rate, cosim::Time time, std::size_t from, std::uint64_t number);
    /// What arrives of it: nothing, itself, several. Asked once for each receiver of each packet, in the
    /// order of start. One that is to come behind the next one is kept until then (take_held).
    std::vector<Passage> pass(const Passage& sent);
    /// Those kept back that go on behind a packet from `from` to `to` that arrives at `arrival`, or whose
    /// time is over before; each with its new arrival.
    std::vector<Passage> take_held(std::size_t from, std::size_t to, cosim::Time arrival);
    /// The same for all whose time is over before `until`.
    std::vector<Passage> take_held_before(cosim::Time until);
    /// When the first one that is kept back arrives at the latest.
    cosim::Time next_held() const;

  private:
    bool meant(std::size_t fault, const Passage& sent) const;
    std::string describe(const Passage& sent) const;

    struct Where {
        std::optional<std::size_t> from, to;
        std::vector<bool> group;  ///< of a partition: who is on one side; empty: each alone
    };
    struct Held {
        cosim::Time latest = 0;
        Passage passage;
    };
    std::vector<cosim::CarriedFault> carried_;
    std::vector<Where> where_;  ///< as carried_
    std::vector<std::string> names_;
    std::vector<Held> held_;
};

}  // namespace puckloop::network
