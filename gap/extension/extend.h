#pragma once
// The unexplained extends the model: a term without a mechanism beside the named causes, and what it gains on
// runs that had no part in it. In each fold causes' numbers are fitted and the term is chosen and learnt on
// the other runs only.

#include "gap/findings/extension.h"
#include "gap/fit/study.h"

#include <cstdint>

namespace puckloop::gap {

/// `none`: the simulator as it is; `named`: with the causes that are named, and what is fitted along.
/// `seed` of the bootstrap over blocks.
Extension extension_of(const Study& study, const Fit& none, const Fit& named, std::uint64_t seed);

}  // namespace puckloop::gap
