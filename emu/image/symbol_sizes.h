#pragma once
// How large a firmware's variables are, for whoever shows them.

#include <cstdint>
#include <map>
#include <string>

namespace puckloop::image {

/// Bytes of each data object of an ELF image, by its symbol's name; a global one wins over a local one. Empty
/// for other formats, which do not say. Throws InputError for a file that cannot be read or is damaged.
std::map<std::string, std::uint32_t> symbol_sizes(const std::string& path);

}  // namespace puckloop::image
