#pragma once
// The decision. All that it rests on comes in as numbers; what follows from them stands in decide.cpp, in the
// order in which it is asked. No effect has a name here.

#include "gap/fit/study.h"
#include "gap/verdict/verdict.h"

#include <cstddef>
#include <string>

namespace puckloop::gap {

/// What was found, from the selection and from everything that looked at what it leaves.
struct Grounds {
    // What was selected.
    std::size_t causes = 0;       ///< effects chosen
    std::size_t candidates = 0;   ///< that could have been
    Gain gain;                    ///< held out, of all causes over the simulator as it is
    bool rival = false;           ///< another effect does as well in the place of a cause that matters
    std::string assumed;          ///< truth that nobody measured, in words; empty: all was
    bool stopped_at_end = false;  ///< a parameter that carries the gain was stopped at the end of its range
    bool error_falls = true;      ///< of few runs: for sure

    std::string
        out_of_role;  ///< why a cause does not do what it is said to do; empty: nothing speaks against
    // Goodness of fit: nats that corrections without a mechanism gain beside the causes.
    double left_by_shape = 0.0;     ///< held out, of functions of all covariates
    double left_by_run = 0.0;       ///< of a number for each run
    double left_by_jump = 0.0;      ///< of a jump inside a run
    bool sums = false;              ///< some observable adds up
    double left_of_readings = 0.0;  ///< of `left_by_shape`, where some do: what those lack that do not
    bool structure = false;         ///< something is left for sure
    std::string not_confirmed;      ///< what the other half of the runs showed; empty: nothing, or not asked

    double left() const;         ///< nats, together
    double unexplained() const;  ///< share of all that is gained
};

/// Why what was chosen is not the cause, in words that follow "but"; empty: nothing speaks against it.
std::string doubt_of(const Grounds& grounds);

/// The word of the verdict. `doubt`: that of the causes, which then are named no more.
Decision decision_of(const Grounds& grounds, const std::string& doubt);

}  // namespace puckloop::gap
