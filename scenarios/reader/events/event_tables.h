#pragma once
// [[event]] tables of a scenario, and the same actions from a command.

#include "physics/events/event.h"
#include "scenarios/values/reader.h"

#include <filesystem>
#include <string_view>

namespace puckloop::scenarios {

/// The [[event]] tables. What they name is checked by physics::check_events(), later.
std::vector<physics::Event> read_events(Reader& top);

/// The [[event]] tables of a file (`--events`); its [[fault]] tables are event_file.h's. Throws InputError.
std::vector<physics::Event> read_event_file(const std::filesystem::path& file);

/// One command, such as "move can to 10 cm, 0 cm". Throws InputError.
physics::Action parse_command(std::string_view text);

}  // namespace puckloop::scenarios
