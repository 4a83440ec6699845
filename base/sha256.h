#pragma once
// SHA-256 (FIPS 180-4) of bytes and of files.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace puckloop {

using Sha256 = std::array<std::uint8_t, 32>;

Sha256 sha256(std::span<const std::uint8_t> bytes);
/// 64 lower-case hexadecimal digits.
std::string sha256_text(std::span<const std::uint8_t> bytes);
std::string sha256_text(std::string_view bytes);
/// The same of a file's bytes; of none if it cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace puckloop
