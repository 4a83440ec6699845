#pragma once
// What a node's work was made of, for `puckloop bench`: facts of this execution, which depend on how grants
// were cut. What was executed and taken back counts as often as it was executed.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::cosim {

/// Name and count, in the order in which they are to be printed.
using WorkCounts = std::vector<std::pair<std::string, std::uint64_t>>;

/// A node that counts its work beside what the conductor counts of every node.
class CountsWork {
  public:
    virtual ~CountsWork() = default;
    /// Appends the counts since the node was made.
    virtual void add_work(WorkCounts& counts) const = 0;
};

}  // namespace puckloop::cosim
