#pragma once
// Inputs that a node only looks at.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <span>
#include <vector>

namespace puckloop::cosim {

/// A node for which some inputs are levels that its program looks at now and then: what comes in there makes
/// nothing happen by itself. Such a node need not wait for it before it looks.
class SampledInputs {
  public:
    virtual ~SampledInputs() = default;
    /// What comes by the port is looked at only. Fixed for the node's life.
    virtual bool sampled(PortIndex port) const = 0;
    /// As Node::advance(), with what comes by sampled ports known before `known` only. That may be stamped
    /// before the time reached, too, but not before a look. Ends at `until`, or where the node would have to
    /// look at what is not known yet, not before `known`; returns where. What the inbox holds from there on
    /// was not taken.
    virtual Time advance_sampling(Time until, Time known, std::span<const Message> inbox,
                                  std::vector<Message>& outbox) = 0;
};

}  // namespace puckloop::cosim
