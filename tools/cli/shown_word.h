#pragma once
// A word that the user gave, in a message about it.

#include "base/plain_text.h"

#include <cstddef>
#include <string>

namespace puckloop::tools {

/// Its first and last bytes where it is long; without what a terminal obeys.
inline std::string shown_word(const std::string& word) {
    constexpr std::size_t kLongest = 100;
    return plain_text(word, kLongest);
}

}  // namespace puckloop::tools
