#pragma once
// A fault in one line, as on the command line: `drop link=robot0.uart from=robot0.linux at=2s`.

#include "base/text/toml_file.h"

#include <string_view>

namespace puckloop::scenarios {

/// The kind, then KEY=VALUE with the keys of a [[fault]] table, values in double quotes where they hold a
/// blank, lists with commas: the table that a scenario would have. Throws InputError.
TomlValue fault_table_of(std::string_view words);

}  // namespace puckloop::scenarios
