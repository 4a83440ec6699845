#pragma once
// Pieces of a path as the program writes it.

#include <cstring>

namespace puckloop::shim {

/// What follows the last slash: all of it where there is none.
inline const char* last_part(const char* path) {
    const char* slash = std::strrchr(path, '/');
    return slash != nullptr ? slash + 1 : path;
}

}  // namespace puckloop::shim
