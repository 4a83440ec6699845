#pragma once
// Source text as lines without comments, .include files read in their place.

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::assembly {

struct SourceLine {
    std::string file;
    int number = 0;
    std::string text;  ///< comment removed
};

/// `file` is the name of `source` for messages; included files are looked for beside the file that names
/// them. Throws InputError: a file that cannot be read, includes nested more than 8 deep.
std::vector<SourceLine> read_source(std::string_view source, const std::string& file);

}  // namespace puckloop::assembly
