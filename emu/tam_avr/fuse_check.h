#pragma once
// What a TAM's fuse bytes would do to it: a chip that was burnt otherwise than the project's boards runs, but
// not as its firmware expects.

#include "emu/avr/devices/fuses.h"
#include "emu/image/avr_image.h"

#include <string>
#include <vector>

namespace puckloop::tam {

/// One line for each fuse that is wrong for this board (TAM fact sheet, section 1), with its byte and what it
/// does; empty for a board in order. BOOTRST is wrong where nothing is where the reset leads.
std::vector<std::string> fuse_warnings(const avr::Fuses& fuses, const image::AvrImage& image);

}  // namespace puckloop::tam
