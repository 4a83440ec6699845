#pragma once
// PNG files as pictures on the floor.

#include "physics/description/floor_image.h"
#include "scenarios/values/reader.h"

#include <filesystem>
#include <string>

namespace puckloop::scenarios {

/// A PNG file, grey or colour, of at most 4096 x 4096 pixels; what is transparent is white. Throws InputError
/// with the file's name.
physics::FloorImage read_png(const std::filesystem::path& file);

/// What is wrong with laying such an image on a floor of `length` x `width` metres: its pixels would be more
/// than 2 % longer than wide, or wider than long. Empty: nothing.
std::string misfit_of(const physics::FloorImage& image, double length, double width);

}  // namespace puckloop::scenarios
