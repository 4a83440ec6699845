#pragma once
// The one criterion by which an effect, or several at once, is taken: the log score of runs that were not
// fitted.
//
// A held-out log score ratio is an e-value: where the simpler model is true, exp(gain) is 1 or less in the
// mean, so that a gain beyond ln(1 / alpha) comes by chance in at most alpha of all cases (Wasserman, Ramdas
// and Balakrishnan, PNAS 117, 2020), and beyond ln(sets / alpha) when the best of so many sets was looked
// for. That holds if the simpler model's noise is right. Against noise that is not, the gain must also stand
// clear of its standard error over runs (Vehtari, Gelman and Gabry, Stat. Comput. 27, 2017).

#include <cstddef>

namespace puckloop::gap {

struct Gain;

/// ln of how many sets of `taken` effects there are among `candidates`: the price of the catalogue's size.
double log_sets(std::size_t candidates, std::size_t taken);

/// nats that the best of such sets must gain.
double needed_gain(std::size_t candidates, std::size_t taken);

/// Is the gain more than chance and more than its own standard error allows for?
bool gains_enough(const Gain& gain, std::size_t candidates, std::size_t taken);

}  // namespace puckloop::gap
