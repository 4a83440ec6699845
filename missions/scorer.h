#pragma once
// The score of a mission, step by step.

#include "missions/mission.h"

#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::missions {

class Scorer {
  public:
    explicit Scorer(Mission mission);

    /// Where all robots are at the end of a step, in an order that stays.
    void step(std::span<const Place> robots);

    /// Of the steps up to now; 0 before the first.
    double score() const;
    std::uint64_t steps() const { return steps_; }

  private:
    bool in_spot(const Place& place) const;
    void forage(std::span<const Place> robots);
    void explore(std::span<const Place> robots);
    double mean_distance() const;

    Mission mission_;
    std::uint64_t steps_ = 0;
    double sum_ = 0.0;
    std::vector<Place> last_;
    std::vector<bool> carries_;        // by robot
    std::vector<std::uint64_t> ages_;  // by cell, row by row
};

}  // namespace puckloop::missions
