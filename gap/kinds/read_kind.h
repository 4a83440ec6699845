#pragma once
// Reads the file of a described kind (docs/gap_kinds.md).

#include "gap/kinds/description.h"
#include "gap/kinds/kind.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace puckloop::gap {

/// InputError with file and line for all that makes it unusable: a unit or a name that is not known, a name
/// twice, a range upside down, formulas in a circle, formulas and parameters without use, a formula that is
/// not a number for values the file calls plausible.
Kind read_kind(const std::filesystem::path& file);

/// Does `text`, where a kind is expected, name a file of one?
bool names_kind_file(std::string_view text);

/// A built-in kind by its name, or one read from a file, whose name is relative to `folder`. InputError at
/// `place` of `file` for what is neither.
Kind kind_stated(const std::string& text, const std::filesystem::path& folder, std::string_view file,
                 std::string_view place);

}  // namespace puckloop::gap
