#pragma once
// Nodes that take turns on an I2C bus: how far each may run ahead so that what the others say next, if all
// goes as foreseen, does not take it by surprise.
//
// A transfer is a chain of phases, each said in answer to the last one: whoever runs ahead for longer than a
// phase is wrong each time. So the nodes of one bus go as far as its phases allow, in turns, without waiting
// for what is sure; only what they say to each other counts. As with Bounds, but of the wires of the bus
// alone. It decides how far is worth going, never what is final.

#include "cosim/core/time.h"
#include "cosim/schedule/bounds.h"

#include <cstddef>
#include <vector>

namespace puckloop::cosim {

class BusTurns {
  public:
    /// Finds the buses again where a wire has been used for the first time.
    void update(const std::vector<Channel>& channels, std::size_t nodes);

    std::size_t count() const { return groups_.size(); }
    const std::vector<std::size_t>& nodes(std::size_t group) const { return groups_[group].nodes; }
    /// Which one node `n` belongs to, or kNobody.
    std::size_t group_of(std::size_t n) const { return n < group_of_.size() ? group_of_[n] : kNobody; }

    /// `heard[n]`: the first message of the bus that node `n` has not executed yet, foreseen or final.
    void compute(std::size_t group, const std::vector<Channel>& channels, const std::vector<Time>& heard);
    /// Nothing of the bus that node `n` does not know of comes in before.
    Time limit(std::size_t n) const { return n < limit_.size() ? limit_[n] : kNever; }
    /// When node `n` sends something by itself at the earliest.
    Time next_send(std::size_t n) const { return next_send_[n]; }

  private:
    struct Group {
        std::vector<std::size_t> nodes, channels;
    };

    std::size_t used_ = 0;  ///< wires
    std::vector<Group> groups_;
    std::vector<std::size_t> group_of_;
    std::vector<Time> limit_, earliest_, next_send_;
};

}  // namespace puckloop::cosim
