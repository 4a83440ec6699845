#pragma once
// Which of two ways to work lets a run go faster shows only when both are tried. What is simulated does not
// depend on it.

#include "cosim/core/time.h"

#include <cstdint>

namespace puckloop::cosim {

class Trial {
  public:
    /// Wall seconds.
    struct Rule {
        int slices;           ///< of a trial: the two ways in turn as in A B B A
        double slice;         ///< length of one
        double margin;        ///< the second way must be so many times as fast as the first
        double first_hold;    ///< what was chosen is held so long ...
        double longest_hold;  ///< ... and longer each time it is chosen again, up to this
    };
    explicit Trial(const Rule& rule) : rule_(rule), slice_(rule.slices) {}

    /// To be called often: `wall` seconds after the run began it had reached `time` with so many grants.
    /// Whether to go the second way from now on.
    bool step(double wall, Time time, std::uint64_t grants);

  private:
    struct Progress {
        double wall = 0;
        double time = 0;
        double grants = 0;
        double rate() const;
    };

    void choose();

    Rule rule_;
    Progress before_;    ///< when the slice under way began
    Progress tried_[2];  ///< by way
    int slice_;          ///< of a trial; the number of slices: none is under way
    double until_ = 0;   ///< end of the slice, or of what was chosen
    bool second_ = false;
    bool chosen_ = false;  ///< by the last trial: the second way
    double hold_ = 0;
};

}  // namespace puckloop::cosim
