#pragma once
// The rival of every cause of events: one chance for all rows, no mechanism. A simulator that loses nothing
// is beaten by it wherever anything is lost at all, so what a cause knows of the losses is what it gains
// beyond.

#include "gap/fit/select.h"

namespace puckloop::gap {

/// nats that one chance gains over the simulator as it is, on rows that were not fitted, of observable `o`; 0
/// where it gains none, or where `o` are no events.
double gained_by_rate(const Study& study, const Selection& selection, std::size_t o);

/// The same on the rows that the chance was learnt from. `cost`: of these rows by the simulator as it is.
double lowered_by_rate(const Observable& observable, double cost);

}  // namespace puckloop::gap
