#pragma once
// Image files before their format is known.

#include <string>
#include <string_view>

namespace puckloop::image {

/// Throws InputError: missing, a directory, larger than 64 MB.
std::string read_image_file(const std::string& path);

/// Intel HEX: the first character that is no white space is a colon.
bool looks_like_hex(std::string_view bytes);

}  // namespace puckloop::image
