#pragma once
// Faults of the network: packets that a computer does not receive, or other than they were sent. Kinds and
// parameters: cosim/faults/kinds/network_kinds.cpp.

#include "base/random.h"
#include "cosim/faults/fault_json.h"
#include "emu/network/connection_faults.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::network {

class NetworkFaults {
  public:
    /// `names`: the computers. Throws InputError for one that is not there.
    NetworkFaults(std::vector<cosim::CarriedFault> faults, std::vector<std::string> names);

    bool empty() const { return carried_.empty(); }
    const std::vector<cosim::CarriedFault>& carried() const { return carried_; }

    /// Whether the access point is away, and each time at which that may change, in order.
    bool is_away(cosim::Time time) const;
    std::vector<cosim::Time> away_changes() const;
    /// Something was for the access point while it was away, or was kept by it when it went. `known`: when
    /// that is certain.
    void missed(cosim::Time time, std::uint64_t number, const std::string& what, cosim::Time known);

    /// What the network carries at most from `time` on, bit/s; `rate` without a fault, 0: without limit.
    double rate(double rate, cosim::Time time, std::size_t from, std::uint64_t number);
    /// What arrives of it: nothing, itself, several. Asked once for each receiver of each packet, in the
    /// order of start. One that is to come behind the next one is kept until then (take_held). Answers of
    /// a fault to its sender are among them.
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
    // What the fault number `index` makes of a packet: `passing` arrives.
    void suffer(std::size_t index, const Passage& sent, std::vector<Passage>& passing);
    void reset(std::size_t index, const Passage& sent, std::vector<Passage>& passing);
    void clash(std::size_t index, const Passage& sent, std::vector<Passage>& passing);

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
    std::vector<ClashedAddress> clashes_;   ///< as carried_
    std::vector<ResetConnections> resets_;  ///< as carried_
};

}  // namespace puckloop::network
