#pragma once
// Which cases a self test of a given size has.

#include "selftest/benches/hidden_case.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap::selftest {

/// Each effect alone at three strengths, pairs, nothing, unknown effects, and pairs the experiment cannot
/// tell apart; `cases` of them (0: all), thinned evenly over the whole list.
std::vector<CasePlan> planned_cases(std::uint64_t seed, std::size_t cases);

HiddenCase make_case(const CasePlan& plan);

}  // namespace puckloop::gap::selftest
