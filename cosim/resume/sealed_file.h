#pragma once
// Files of saved states: a line of text that states what it is, the format's number, the content, and a
// SHA-256 over all of it. Written whole or not at all.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

struct SealedKind {
    std::string_view first_line;  ///< with its newline
    std::uint32_t format = 0;
    std::string_view file;       ///< "state file", for messages
    std::string_view content;    ///< "state"
    std::string_view expected;   ///< "a file written by --save-state"
    std::uintmax_t largest = 0;  ///< greater ones are not read, bytes
};

std::vector<std::uint8_t> seal(const SealedKind& kind, std::span<const std::uint8_t> content);
/// The content, within `bytes`. Throws InputError naming `name`: another kind of file, another format, cut
/// short, damaged.
std::span<const std::uint8_t> unseal(const SealedKind& kind, std::span<const std::uint8_t> bytes,
                                     const std::string& name);

/// Throws InputError if it cannot be read or is too large.
std::vector<std::uint8_t> read_sealed(const SealedKind& kind, const std::filesystem::path& path);
/// Under a name of its own first, then renamed: readers see the old file or the new one. Mode 0600. Throws
/// RunError.
void write_whole(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace puckloop::cosim
