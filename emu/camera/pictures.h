#pragma once
// Things to look at without a world: a test pattern, and a picture file.

#include "emu/camera/scenery.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::camera {

/// Colour bars (white, yellow, cyan, green, magenta, red, blue, black from the left) over the upper three
/// quarters, a grey ramp below that is dark on the left; a white square in the upper left corner.
std::unique_ptr<Scenery> make_test_pattern();

/// An image in rows from the top, red, green and blue.
struct Pixels {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};
/// PGM or PPM, binary or plain (P2, P3, P5, P6), at most 4096 x 4096. Throws InputError with `name`.
Pixels read_pnm(std::string_view bytes, const std::string& name);

/// The picture fills the field of view, stretched to it.
std::unique_ptr<Scenery> make_picture(Pixels pixels);
/// The same of a file. Throws InputError.
std::unique_ptr<Scenery> make_picture(const std::string& file);

}  // namespace puckloop::camera
