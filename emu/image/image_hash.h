#pragma once
// Whether a file is still the image that was meant.

#include <string>

namespace puckloop::image {

/// Throws InputError if it is another one; an empty `expected` is any.
void check_hash(const std::string& file, const std::string& sha256, const std::string& expected);

}  // namespace puckloop::image
