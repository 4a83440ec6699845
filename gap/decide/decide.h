#pragma once
// The decision. All that it rests on comes in as numbers; what follows from them stands in decide.cpp, in the
// order in which it is asked. No effect has a name here.

#include "gap/evidence/criterion.h"

#include <cstddef>
#include <string>

namespace puckloop::gap {

enum class Decision { Named, CannotTell, NoEffect, Unexplained, NotIdentifiable };

/// What a decision rests on.
struct Grounds {
    // What was selected.
    std::size_t causes = 0;       ///< effects chosen
    std::size_t candidates = 0;   ///< that could have been
    Gain gain;                    ///< held out, of all causes over the simulator as it is
    bool rival = false;           ///< another effect does as well in the place of a cause that matters
    std::string assumed;          ///< truth that nobody measured, in words; empty: all was
    bool stopped_at_end = false;  ///< a parameter that carries the gain was stopped at the end of its range
    bool in_rounding = false;     ///< no cause moves readings by more than their rounding
    bool error_falls = true;      ///< of few runs: for sure
    bool law_alone = false;       ///< a law of errors without a mechanism gains as much
    std::string not_identified;   ///< why these data cannot identify the causes; empty: they can
    std::string out_of_role;      ///< why a cause does not do what it is said to do; empty: all do

    // Goodness of fit: nats that corrections without a mechanism gain beside the causes, on held-out rows.
    double left_by_shape = 0.0;      ///< of functions of all covariates
    double left_by_form = 0.0;       ///< of a cause's form, bent
    double left_by_run = 0.0;        ///< of a number for each run
    double left_by_structure = 0.0;  ///< that the surest structure left may stand for
    double left_of_readings = 0.0;   ///< by shape or structure, of observables that do not add up
    bool sums = false;               ///< some observable adds up
    bool structure = false;          ///< something is left for sure
    bool only_wanders = false;       ///< that sums wander, and nothing else
    std::string not_confirmed;       ///< what the other half of the runs showed; empty: nothing, or not asked

    double left() const;         ///< nats, together
    double unexplained() const;  ///< share of all that is gained
};

/// The first thing that speaks against naming the causes, in words that follow "but"; empty: nothing does, or
/// there are none.
std::string doubt_of(const Grounds& grounds);

/// The word of the verdict. `doubt`: that of the causes, which then are named no more.
Decision decision_of(const Grounds& grounds, const std::string& doubt);

}  // namespace puckloop::gap
