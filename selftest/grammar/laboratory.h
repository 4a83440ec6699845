#pragma once
// What a laboratory's log does to any experiment, whatever is hidden in it: whole milliseconds, coarse
// readings, half of the runs. None of it is an effect.

#include "base/random.h"
#include "gap/data/written.h"

#include <optional>
#include <string>

namespace puckloop::gap::selftest::grammar {

struct Laboratory {
    double clock = 0.0;                 ///< s to which times are rounded; 0: as measured
    bool coarse = false;                ///< readings and poses are rounded to about the size of their noise
    bool stated = true;                 ///< [instrument] says so; else it says nothing
    bool one_pass = false;              ///< every condition once, not twice
    std::optional<RandomStream> fewer;  ///< only so many runs, two or more, drawn evenly in the logarithm

    static Laboratory draw(RandomStream& random);
    /// Leaves out the runs that it does not do; before anything is hidden, or what is hidden might be in
    /// these. One pass of a session is one: what differs between two is not left out.
    void plan(WrittenExperiment& experiment);
    /// Rounds what was measured.
    void keep(WrittenExperiment& experiment) const;
    std::string text() const;
};

}  // namespace puckloop::gap::selftest::grammar
