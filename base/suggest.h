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

}  // namespace puckloop
