#pragma once
// Processes that serve nodes of a run and were not started by its conductor: on other machines, perhaps.

#include "cosim/remote/node_line.h"

#include <memory>

namespace puckloop::cosim {

class NodeHosts {
  public:
    virtual ~NodeHosts() = default;

    /// Hosts are numbered from 1 on; 0 is the conductor's own process.
    virtual unsigned count() const = 0;
    /// To a node on `host` that is yet to be described. The hosts outlive it.
    virtual std::unique_ptr<NodeLine> line_to(unsigned host) = 0;
    /// Waits until something has come by any of the lines, or some tenths of a second.
    virtual void await_answers() = 0;
};

}  // namespace puckloop::cosim
