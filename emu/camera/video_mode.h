#pragma once
// What a camera's registers come to: when its lines are high, which pixel is on the data lines when, and how
// a pixel is written. Decoded by each model (po3030k.cpp and its neighbours), carried out by VideoTiming and
// Camera.

#include "emu/camera/automatic.h"

#include <array>
#include <cstdint>

namespace puckloop::camera {

/// The array of each camera.
inline constexpr std::uint32_t kArrayWidth = 640, kArrayHeight = 480;

enum class PixelFormat : std::uint8_t { Rgb565, Yuv, Grey };

struct VideoMode {
    /// Master clocks that a pixel of the array lasts, in thirds (one divider of the PO3030K is 8/3).
    std::uint32_t pixel_thirds = 3 * 16;
    std::uint32_t frame_width = 852, frame_height = 489;  ///< in pixels and rows, blanking included
    /// Master clocks that a pixel that comes out lasts, in thirds; 0: as long as the array's that it is of.
    std::uint32_t out_pixel_thirds = 0;
    std::uint32_t step = 1;  ///< every step-th pixel of every step-th row comes out
    std::uint32_t first_column = 210,
                  end_column = 850;                   ///< HREF is high from the first to before the end ...
    std::uint32_t first_row = 7, end_row = 487;       ///< ... in every step-th of these rows
    std::uint32_t array_column = 210, array_row = 7;  ///< where the array's first pixel is
    std::uint32_t vsync_row = 7, vsync_end_row = 487, vsync_column = 1;  ///< VSYNC rises and falls here
    PixelFormat format = PixelFormat::Rgb565;
    bool mirror = false, flip = false;          ///< left and right, top and bottom changed over
    std::array<double, 3> gain{1.0, 1.0, 1.0};  ///< by hand: of red, green, blue, over the default exposure's
    AutomaticSettings automatic{};
    double brightness = 0.0;  ///< share of full scale, added
    double contrast = 1.0;    ///< about mid-grey

    std::uint32_t bytes_per_pixel() const { return format == PixelFormat::Grey ? 1 : 2; }
    bool same_timing(const VideoMode& other) const {
        return pixel_thirds == other.pixel_thirds && out_pixel_thirds == other.out_pixel_thirds &&
               frame_width == other.frame_width && frame_height == other.frame_height && step == other.step &&
               first_column == other.first_column && end_column == other.end_column &&
               first_row == other.first_row && end_row == other.end_row && vsync_row == other.vsync_row &&
               vsync_end_row == other.vsync_end_row && vsync_column == other.vsync_column &&
               format == other.format;
    }
};

}  // namespace puckloop::camera
