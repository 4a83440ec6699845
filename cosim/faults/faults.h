#pragma once
// Faults of links: what they do to the messages of one direction. Each has its own random stream, so that
// adding one never changes what another does, and keeps evidence of what it did.

#include "cosim/core/link.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "cosim/faults/evidence.h"
#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/spec/fault_kind.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// A message on its way: `message.time` is when it will be delivered.
struct Delivery {
    Message message;
    FaultKind fault = FaultKind::None;
    bool back = false;  ///< arrives at its own sender; only on links with a loopback() fault
};

/// The message as its sender sent it.
struct Sending {
    Time delivery = 0;        ///< had there been no fault
    std::uint64_t index = 0;  ///< counts those sent in this direction of the link, from 0
};

/// One fault on one direction of one link.
class LinkFault {
  public:
    virtual ~LinkFault() = default;
    /// May change the deliveries that one sent message became, add to them, or mark them as kept from
    /// arriving; never makes one earlier. Called in the order in which the messages were sent.
    virtual void apply(std::vector<Delivery>& batch, const Sending& sending) = 0;
    /// What the fault itself puts on the line, known before the run. Called once.
    virtual std::vector<Delivery> preset() { return {}; }

    const Evidence& evidence() const { return evidence_; }

  protected:
    Evidence evidence_;
};

/// The direction of a link that a fault sits on.
struct WireSite {
    Direction direction = Direction::FromA;
    Time flight = 0;   ///< of the link
    Time latency = 0;  ///< of the link
    PlaceKind place = PlaceKind::Uart;
    std::string sender{};  ///< the node's name
};

/// What is brought back arrives this much behind its time at the far end. A sender that heard itself at the
/// very instant at which it sends would wait for itself.
inline constexpr Time kTurnRound = kNanosecond;
/// Whether the fault may bring messages back to their senders.
bool loops_back(const FaultSpec& spec);

/// `index` is the fault's place in the list (names its random stream). Throws InputError for a kind that
/// such a link cannot suffer and for parameters out of range.
std::unique_ptr<LinkFault> make_fault(const FaultSpec& spec, const WireSite& site, std::uint64_t seed,
                                      std::size_t index);

}  // namespace puckloop::cosim
