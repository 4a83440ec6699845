#pragma once
// States of boards as a file: a line of text, the format's number, the build that wrote it, the boards, and a
// SHA-256 over all of it. Files are written whole or not at all.

#include "cosim/resume/board_state.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// Rises whenever what a chip, module, board or node lists as its state changes.
inline constexpr std::uint32_t kStateFormat = 1;

struct StateFile {
    std::string build;  ///< build_id() of the program that wrote it
    std::vector<BoardState> boards;
};

std::vector<std::uint8_t> encode(const StateFile& file);
/// Throws InputError naming `name`: no state file, another format, damaged.
StateFile decode(std::span<const std::uint8_t> bytes, const std::string& name);

/// Throws InputError as decode(), or if the file cannot be read.
StateFile read_state_file(const std::filesystem::path& path);
/// Under a name of its own first, then renamed: readers see the old file or the new one. Mode 0600. Throws
/// RunError.
void write_state_file(const std::filesystem::path& path, const StateFile& file);

/// Which build of the program this is: the linker's build id, or a SHA-256 of the program's file. Two builds
/// that may behave differently never share one.
const std::string& build_id();

}  // namespace puckloop::cosim
