#pragma once
// Checks for numbers on the command line. CLI11's own let "nan" through a range and "-1" through an unsigned
// count.

#include <CLI/CLI.hpp>

#include <cstdint>
#include <limits>

namespace puckloop::tools {

/// A finite number from `low` to `high`, both included.
CLI::Validator number_between(double low, double high);

/// A finite number above 0.
CLI::Validator positive_number();

/// Of every --seed.
constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::uint64_t>::max();

/// Digits only, at most `most`.
CLI::Validator count_up_to(std::uint64_t most);

/// Not "": an empty variable in a script, which would be taken for an option that was not given.
CLI::Validator not_empty();

}  // namespace puckloop::tools
