#pragma once
// Where a drawn effect enters an experiment. Tables of sensors are changed row by row; a drive's poses are
// taken apart into what each wheel made from row to row, changed, and put together again.

#include "selftest/grammar/field.h"

namespace puckloop::gap::selftest::grammar {

struct Site {
    enum class How {
        Times,  ///< the column times 1 + a field
        Plus,   ///< the column plus a field, in units of its noise
        Lost,   ///< an event fails with the probability a |field|
        LeftWheel,
        RightWheel,
        BothWheels,  ///< what the wheels make of a step, times 1 + a field
        Heading,     ///< the robot turns by a field a row while it moves
        Aside,       ///< the robot slides sideways while it moves
    };
    How how = How::Times;
    std::string column;
    double unit = 1.0;  ///< of `Plus`: the column's noise
    std::string text() const;
};

/// All of a kind that may be drawn.
std::vector<Site> sites_of(const std::string& kind);

/// The exact experiment with the effect at amplitude `a`. `chance` decides what is lost.
WrittenExperiment with_effect(const WrittenExperiment& exact, const Site& site, const Field& field, double a,
                              RandomStream chance);

}  // namespace puckloop::gap::selftest::grammar
