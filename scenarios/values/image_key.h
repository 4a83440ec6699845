#pragma once
// `firmware` of a board: a path, or an image that comes with the program.

#include "scenarios/values/reader.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace puckloop::scenarios {

/// The key `firmware` of a main board ("pic") or a range-and-bearing board ("rab"). The name of a shipped
/// image of that board, "own" being the one for ordinary use, or a file: relative to the scenario's folder,
/// and where it is not there, by its name among the shipped images, so that a scenario copied elsewhere
/// works. Throws InputError where the key is missing and where a text without dot and slash is neither.
std::filesystem::path read_firmware(Reader& reader, std::string_view board);

/// The same of a text alone, relative to `folder` (empty: the working directory); `board` may be
/// "tam" too, or "" for files and names of files alone.
/// Empty: it is no shipped image, and no such file is there.
std::filesystem::path firmware_named(const std::filesystem::path& folder, const std::string& text,
                                     std::string_view board);

}  // namespace puckloop::scenarios
