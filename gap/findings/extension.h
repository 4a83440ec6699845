#pragma once
// What remains beside every named cause, learnt without a mechanism, and what it gains on runs that had no
// part in learning it.

#include <cmath>
#include <string>
#include <vector>

namespace puckloop::gap {

/// One table of the learnt term, as the overlay has it (physics/description/extension.h), SI units.
struct LearntTable {
    int sensor = -1;                      ///< -1: all
    std::string times;                    ///< covariate that it is a share of; empty: none
    std::vector<std::string> over;        ///< covariates, two at most; none: one number
    std::vector<std::vector<double>> at;  ///< rising, of each covariate
    std::vector<double> value, sd;        ///< the last covariate fastest
    double run_spread = 0.0;              ///< sd of an offset of each run
};

/// One observable with the term that was learnt for it.
struct Extended {
    std::string observable, unit;
    std::string quantity;       ///< of the world, to which it adds; empty: the world has no such place
    std::string quantity_unit;  ///< of the table's values
    /// rms errors of runs that were not fitted: the simulator as it is, with the named causes, with the term.
    double before = 0.0, named = 0.0, extended = 0.0;
    double ratio = 1.0, low = 1.0, high = 1.0;  ///< extended over named, 90 % over blocks
    double gain = 0.0, gain_sd = 0.0;           ///< nats on these runs, over the named causes
    int better = 0, blocks = 0;                 ///< held-out blocks
    bool kept = false;                          ///< the gain is clear: the term counts
    std::string formula;                        ///< that fits as well; empty: no short one does
    std::vector<LearntTable> tables;            ///< fitted to all runs; empty unless kept
};

struct Extension {
    std::string not_asked = "nothing was found";  ///< why it was not; empty: it was
    bool by_runs = true;                          ///< held out were whole runs, not stretches of them
    std::vector<Extended> observables;
    std::string sentence;

    bool kept() const {
        for (const Extended& one : observables)
            if (one.kept) return true;
        return false;
    }
    /// Does a run take any of it?
    bool enters() const {
        for (const Extended& one : observables)
            if (one.kept && !one.quantity.empty()) return true;
        return false;
    }
};

}  // namespace puckloop::gap
