#pragma once
// `firmware` of a board: a path, or an image that comes with the program.

#include "scenarios/reader/reader.h"

#include <filesystem>
#include <string_view>

namespace puckloop::scenarios {

/// "own": the project's own image, `own` by the name of its file. A path is relative to the scenario's
/// `folder`; a bare name that is not there is looked for among the shipped images, so that a scenario copied
/// elsewhere works. Throws InputError where the key is missing.
std::filesystem::path read_firmware(Reader& reader, const std::filesystem::path& folder,
                                    std::string_view own);

}  // namespace puckloop::scenarios
