#pragma once
// "Did you mean": the known name closest to a misspelt one.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop {

/// Fewest insertions, deletions, replacements of one character and swaps of two neighbours that turn `left`
/// into `right`; letter case counts for nothing.
std::size_t edit_distance(std::string_view left, std::string_view right);

/// The first of `known` with the smallest distance to `name`, at most 2 (1 for names of three letters or
/// fewer); empty if none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string_view>& known);

/// The nearest of `known` to a misspelt name, at most three at the same distance, which is at most 1 (names
/// of three letters or fewer), 2 or, from eleven letters on, 3. If none is so near, those that begin or end
/// with `name` as whole words: "theta_rad" for "theta", "robot.axle_length" for "axle_length".
std::vector<std::string> near_names(std::string_view name, const std::vector<std::string_view>& known);

/// "; did you mean \"a\", \"b\" or \"c\"?" of these; empty if none is near.
std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace puckloop
