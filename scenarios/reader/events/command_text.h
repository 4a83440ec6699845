#pragma once
// Commands as text, "move can to 10 cm, 0 cm": to the table that an [[event]] would hold, and back.

#include "base/text/toml_file.h"

#include <string>
#include <string_view>

namespace puckloop::scenarios {

/// Splits words into the verb's key and the keys that follow; what they are worth is for read_action().
/// Throws InputError naming the command.
TomlValue parse_command_text(std::string_view text);

/// The verb of an action's table: its only key that is one. Empty if there is none or more than one.
std::string verb_of(const TomlValue& table);

/// The verb and its keys in `table` as one line for a user, or as lines of TOML.
std::string command_text(const TomlValue& table);
std::string toml_text(const TomlValue& table);
/// A value that is no table, as TOML has it.
std::string toml_value(const TomlValue& value);

}  // namespace puckloop::scenarios
