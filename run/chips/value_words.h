#pragma once
// A place in a chip as people type it, and what it is compared with: one reader for the page, the shell,
// Python and scenarios.

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::tools {

/// "TMR1" (a register, as data sheets write them, or w0), "U2STA.TRMT" (a field), "counter" (a variable) or
/// "0x850:4" (memory) as keys of `read`. Throws InputError: none of these.
nlohmann::json place_of_words(std::string_view text);

/// `TMR1 >= 9` or `robot0.pic counter == 3` as keys of `read`, with "is" and "value", and "node" where there
/// is one. Nothing: no comparison. Throws InputError: one of something that is no place or number.
std::optional<nlohmann::json> comparison_of_words(std::string_view text);

/// `is`: ==, !=, <, >, <= or >=. Throws InputError: another.
bool comparison_holds(std::uint64_t value, std::string_view is, std::uint64_t other);

/// What `read` gave, for people: "0x3723 14115", a register's fields that are not 0 behind it.
std::string value_text(const nlohmann::ordered_json& reply);

/// Throws InputError for more than 500 characters, naming `what`.
void refuse_long_words(std::string_view text, const char* what);

}  // namespace puckloop::tools
