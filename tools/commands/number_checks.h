#pragma once
// Checks for numbers on the command line. CLI11's own let "nan" through a range and "-1" through an unsigned
// count.

#include <CLI/CLI.hpp>

#include <cstdint>

namespace puckloop::tools {

/// A finite number from `low` to `high`, both included.
CLI::Validator number_between(double low, double high);

/// A finite number above 0.
CLI::Validator positive_number();

/// Digits only, at most `most`.
CLI::Validator count_up_to(std::uint64_t most);

}  // namespace puckloop::tools
