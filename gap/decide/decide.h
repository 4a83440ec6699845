#pragma once
// The decision. All that it rests on comes in as numbers; what follows from them stands in decide.cpp, in the
// order in which it is asked. No effect has a name here.

#include "gap/decide/grounds.h"
#include "gap/verdict/verdict.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// Everything that speaks against naming the causes, in words that follow "but", in the order in which it is
/// asked; empty: nothing does, or there are none.
std::vector<std::string> objections(const Grounds& grounds);
/// The first of them.
std::string doubt_of(const Grounds& grounds);

/// The word of the verdict. `doubt`: that of the causes, which then are named no more.
Decision decision_of(const Grounds& grounds, const std::string& doubt);

}  // namespace puckloop::gap
