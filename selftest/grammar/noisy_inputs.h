#pragma once
// Cases in which nothing is wrong with the robot, but what went in was noted with errors: counters and
// commands, distances and angles of a stage, greys of a floor, clocks. Any cause that is named for them is a
// wrong name.

#include "selftest/grammar/drawn_case.h"

#include <cstdint>

namespace puckloop::gap::selftest::grammar {

/// Case `number` of a run with this seed. Kinds take turns; the column, the size of its errors and whether
/// rows at one value share them are drawn.
DrawnCase noisy_input_case(std::size_t number, std::uint64_t seed);

}  // namespace puckloop::gap::selftest::grammar
