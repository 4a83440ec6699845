#pragma once
// A scenario file with the files that it includes, as one tree.

#include "base/text/toml_file.h"

#include <filesystem>
#include <vector>

namespace puckloop::scenarios {

/// Reads `file` and what its key `include` names: a file or a list of them, relative to the file that names
/// it. Lists of tables are put together, included ones first; of a table and of a plain key the including
/// file's value counts. `files` gets every file in the order of reading. Throws InputError with file and
/// line, also where files include each other in a ring.
TomlValue read_with_includes(const std::filesystem::path& file, std::vector<std::filesystem::path>& files);

}  // namespace puckloop::scenarios
