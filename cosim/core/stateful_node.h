#pragma once
// A node whose whole state can be saved between two advances, and loaded into a fresh node of the same kind.

#include "base/states/archive.h"
#include "cosim/core/node.h"

namespace puckloop::cosim {

class StatefulNode : public Node {
  public:
    virtual void state(StateWriter& archive) const = 0;
    /// Into a node that was never advanced, which then goes on as the saved one would have. Throws StateError
    /// if it does not fit; the node is of no use then.
    virtual void state(StateReader& archive) = 0;
    /// After loading another board's state: random streams begin anew, by this node's own name and seed.
    virtual void renew_random_streams() = 0;
};

}  // namespace puckloop::cosim
