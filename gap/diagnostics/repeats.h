#pragma once
// Does what passes for scatter repeat at once? Noise that grows with a reading errs anew each time; a mean
// that the model lacks is there again when the same is read again.

#include "gap/fit/study.h"

#include <vector>

namespace puckloop::gap {

/// How many standard deviations of chance the errors of rows agree better with those of the rows just before,
/// both of one stimulus and truth, where the effects `scatter` make most of their noise than where they make
/// little of it. (The same everywhere is noise that carries over.)
double repeats_at_once(const Study& study, const Fit& fit, const std::vector<std::size_t>& scatter);

}  // namespace puckloop::gap
