#pragma once
// A learnt term as a short formula, where one fits as well: sparse regression over elementary functions of
// its covariates and their products.

#include "gap/extension/learn.h"

#include <string>

namespace puckloop::gap {

/// "0.012 + 0.31 speed x time", SI units, three summands at most; empty: none fits the rows as well as the
/// tables do.
std::string formula_of(const Subject& subject, const std::vector<char>& used, const Learnt& learnt);

}  // namespace puckloop::gap
