#pragma once
// Whether chips translate hot code to the host's: asked by each core when it is made.

#include <cstdint>

namespace puckloop::chip {

/// A block takes as long to make as some ten thousand instructions to interpret.
inline constexpr std::uint8_t kHot = 40;

struct Translation {
    bool on = true;
    std::uint8_t hot = kHot;  ///< how often a place is come to before it is translated, 1..254
};

/// For cores made from now on in this process (`--no-translate`).
void set_translation(bool on, std::uint8_t hot = kHot);
Translation translation();

}  // namespace puckloop::chip
