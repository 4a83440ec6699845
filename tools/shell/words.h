#pragma once
// What is typed into the shell, as requests of the control protocol.

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace puckloop::tools {

/// "TMR1" (a register, as data sheets write them, or w0), "counter" (a variable) or "0x850:4" (memory) as
/// keys of `read`. "U2STA.TRMT" has `field` set. Nothing: none of these.
std::optional<nlohmann::json> place_words(std::string_view text, std::string& field);

/// `TMR1 >= 9` (of `board`), `robot0.pic counter == 3`, `text "ok"`, `frame link=robot0.uart value=4e` as
/// `until` of a step. Throws InputError.
nlohmann::json condition_words(std::string_view text, const std::string& board);

}  // namespace puckloop::tools
