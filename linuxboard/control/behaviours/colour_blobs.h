#pragma once
// Spots of one colour in a picture of the omnidirectional camera, and where they are around the robot.
//
// Hue is that of HSV, in degrees (0 red, 120 green, 240 blue). Neighbouring pixels of the colour form a blob.
// Its middle gives the bearing; the distance follows from the middle's distance to the mirror's in pixels, by
// the curve a * b^pixels that ARGoS uses for TAMs.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace puckloop::control {

struct ColourRange {
    double hue = 120;           ///< degrees
    double hue_tolerance = 30;  ///< to either side
    int saturation = 100;       ///< at least, of 255
    int value = 130;            ///< at least, of 255
};
/// "red", "green", "blue", "yellow", "cyan" or "magenta"; nothing for another name.
std::optional<ColourRange> colour_named(std::string_view name);

/// Geometry of the picture, at 352 x 288; scaled with the picture's height.
struct MirrorCalibration {
    double centre_u = 182, centre_v = 144;  ///< pixels
    double radius = 137;                    ///< pixels: what is farther out is not looked at
    double curve_a = 1.25455;               ///< cm
    double curve_b = 1.03848;               ///< a pixel
};

struct ColourBlob {
    double bearing = 0;      ///< rad, -pi..pi, counter-clockwise from straight ahead
    double distance_cm = 0;  ///< from the robot's middle, by the curve
    int area = 0;            ///< pixels
};

/// The blobs of at least `least` pixels in a YUYV picture, largest first.
std::vector<ColourBlob> find_blobs(std::span<const std::uint8_t> yuyv, std::size_t width, std::size_t height,
                                   const ColourRange& colour, const MirrorCalibration& mirror, int least = 4);

}  // namespace puckloop::control
