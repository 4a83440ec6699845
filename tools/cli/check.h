#pragma once
// What an option's value has to satisfy. CLI11's own checks of numbers let "nan" through a range and "-1"
// through an unsigned count.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace puckloop::tools {

struct Check {
    std::function<std::string(const std::string& text)> wrong;  ///< empty, or what is wrong with `text`
    std::string shown;                                          ///< in the help
};

/// A finite number from `low` to `high`, both included.
Check number_between(double low, double high);

/// A whole number from `low` to `high`, both included.
Check whole_number_between(int low, int high);

/// A finite number above 0.
Check positive_number();

/// Of every --seed.
constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::uint64_t>::max();

/// Digits only, at most `most`.
Check count_up_to(std::uint64_t most);

/// Not "": an empty variable in a script, which would be taken for an option that was not given.
Check not_empty();

Check one_of(const std::vector<std::string>& words);

}  // namespace puckloop::tools
