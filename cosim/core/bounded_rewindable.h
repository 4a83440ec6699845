#pragma once
// A node that can go back, but not from beyond what it does together with something outside of simulated
// time, such as a program in a process of its own.

#include "cosim/core/node.h"

#include <span>

namespace puckloop::cosim {

/// Node::rewindable() is always the same one, or always null.
class BoundedRewindable : public Rewindable {
  public:
    /// Before this nothing happens that cannot be taken back, as the node now stands. `next`: what comes in
    /// next, all of one time; empty: nothing is known. Not before the time reached.
    virtual Time horizon(std::span<const Message> next) const = 0;
};

}  // namespace puckloop::cosim
