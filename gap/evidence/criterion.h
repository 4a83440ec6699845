#pragma once
// The one criterion by which an effect, or several at once, is taken: the log score of runs that were not
// fitted.
//
// A held-out log score ratio is an e-value: where the simpler model is true, exp(gain) is 1 or less in the
// mean, so that a gain beyond ln(1 / alpha) comes by chance in at most alpha of all cases (Wasserman, Ramdas
// and Balakrishnan, PNAS 117, 2020), and beyond ln(sets / alpha) when the best of so many sets was looked
// for. That holds if the simpler model's noise is right. Against noise that is not, the gain must also stand
// clear of its standard error over runs (Vehtari, Gelman and Gabry, Stat. Comput. 27, 2017). What is rare
// shows in few runs, by very different amounts, and no standard error over runs is small: there it must be
// enough without the run that gains most, and no run may clearly lose.

#include <cstddef>
#include <vector>

namespace puckloop::gap {

/// nats on held-out rows: more than chance.
inline constexpr double kClearGain = 3.0;

struct Gain {
    double sum = 0.0, sd = 0.0;                 ///< sd of the sum, from the spread between blocks
    double share_better = 0.0;                  ///< of the blocks
    int clearly_better = 0, clearly_worse = 0;  ///< blocks, by kClearGain
    double without_best = 0.0;                  ///< sum over all blocks but the one that gains most

    /// What is rare, or shows in few runs only, is not seen in most blocks, but more than once; and it is not
    /// one block's doing: what the others lose does not eat up what the second best gains.
    bool in_several(double needed = kClearGain) const {
        return clearly_better > 1 && clearly_worse == 0 && without_best > needed;
    }
};
Gain gain_of(const std::vector<double>& by_block);

/// nats that the best set of `taken` effects among `candidates` must gain: ln of how many such sets there are
/// is the price of the catalogue's size.
double needed_gain(std::size_t candidates, std::size_t taken);

/// Is the gain more than chance, and more than its own standard error allows for or than one run makes?
bool gains_enough(const Gain& gain, std::size_t candidates, std::size_t taken);

}  // namespace puckloop::gap
