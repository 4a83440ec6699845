#pragma once
// Variables of a scenario: [variables] names values, ${NAME} in a text is one, --set replaces them.

#include "base/text/toml_file.h"

#include <string>
#include <vector>

namespace puckloop::scenarios {

/// Replaces ${NAME} in every text of `root` by the value that [variables] gives, or one of `set`
/// ("NAME=VALUE"); a text that is nothing but ${NAME} becomes the value itself, number, truth value or list.
/// $${ is a plain ${. [variables] is taken out. Without it, texts stay as they are. Throws InputError with
/// file and line for a name that is not there, and for an assignment to one that is not there or of another
/// kind.
void resolve_variables(TomlValue& root, const std::string& file, const std::vector<std::string>& set);

}  // namespace puckloop::scenarios
