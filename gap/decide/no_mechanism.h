#pragma once
// The rivals that need no mechanism.
//
// Of every cause that makes single errors large: errors of which a few are larger, nothing said of when or
// which way (the contaminated normal law; Tukey 1960, "A survey of sampling from contaminated
// distributions").
//
// Of every cause of events: one chance for all rows. A simulator that loses nothing is beaten by it wherever
// anything is lost at all, so what a cause knows of the losses is what it gains beyond.

#include "gap/fit/select.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// Log score of each block by the observables `touched`. Errors of `fit`, but for those that its causes make,
/// follow such a law, fitted to the other blocks, wherever that gains over the Student t of its noise.
std::vector<double> scores_with_large_errors(const Study& study, const Fit& fit,
                                             const std::vector<std::string>& touched);

/// nats that one chance gains over the simulator as it is, on rows that were not fitted, of observable `o`; 0
/// where it gains none, or where `o` are no events.
double gained_by_rate(const Study& study, const Selection& selection, std::size_t o);

/// The same on the rows that the chance was learnt from. `cost`: of these rows by the simulator as it is.
double lowered_by_rate(const Observable& observable, double cost);

}  // namespace puckloop::gap
