#pragma once
// What people type to a run, as requests of the control protocol (docs/control_protocol.md): page, shell and
// Python send such texts as they are, so that they are read in one place.

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

namespace puckloop::tools {

/// `TMR1 >= 9` (of `board`), `robot0.pic counter == 3`, `text "ok"`, `frame link=robot0.uart value=4e` as
/// `until` of a step. Throws InputError.
nlohmann::json condition_of_words(std::string_view text, const std::string& board);

/// `link=robot0.uart value=4e` as `frame` of a condition or of `capture`. Throws InputError.
nlohmann::json frame_of_words(std::string_view text);

}  // namespace puckloop::tools
