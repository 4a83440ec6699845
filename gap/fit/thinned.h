#pragma once
// A part of a large experiment, on which fits are begun and the hopeless ones told from the others.

#include "gap/data/experiment.h"

#include <cstddef>

namespace puckloop::gap {

/// Stretches of rows from all over every run, each a run of its own, about `rows` together.
Experiment thinned(const Experiment& experiment, std::size_t rows);

}  // namespace puckloop::gap
