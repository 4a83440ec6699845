#pragma once
// Inputs that a node waits for only when it comes to need them.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <optional>
#include <span>
#include <vector>

namespace puckloop::cosim {

/// How far a node with SampledInputs may go.
struct SampledReach {
    Time until = 0;
    Time known = kNever;     ///< what comes by sampled ports is known before this
    Time answered = kNever;  ///< in its turn: nothing comes by the turn's port before this, whatever it sends
};

/// A node for which some inputs are levels that its program looks at now and then: what comes in there makes
/// nothing happen by itself. Such a node need not wait for it before it looks. And a node that talks with
/// another in turns need not wait for that while the turn is its own.
class SampledInputs {
  public:
    virtual ~SampledInputs() = default;
    /// What comes by the port is looked at only. Fixed for the node's life.
    virtual bool sampled(PortIndex port) const = 0;
    /// What comes by sampled ports makes nothing leave by this port before its EOT, and its lookahead()
    /// counts from what comes in elsewhere. Fixed for the node's life.
    virtual bool independent(PortIndex /*port*/) const { return false; }
    /// The port by which the node talks in turns, if there is one. Fixed for the node's life.
    virtual std::optional<PortIndex> turn_port() const { return std::nullopt; }
    /// Nothing comes by that port now before the node has sent something there; asked after each advance.
    virtual bool has_turn() const { return false; }
    /// As Node::advance(), with what comes by sampled ports known before `reach.known` only. That may be
    /// stamped before the time reached, too, but not before a look. Ends at `reach.until`, or where the node
    /// would have to look at what is not known yet, not before `reach.known`; if it had the turn and has sent
    /// something by that port, behind that, not before `reach.answered`. Returns where. What the inbox holds
    /// from there on was not taken.
    virtual Time advance_sampling(const SampledReach& reach, std::span<const Message> inbox,
                                  std::vector<Message>& outbox) = 0;
};

}  // namespace puckloop::cosim
