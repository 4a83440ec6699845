#pragma once
// What the cameras of a Linux board look at. Whoever knows the world implements it; the devices know only
// this.

#include "cosim/core/time.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace puckloop::linuxboard {

/// How a camera is set when a frame begins.
struct PictureSettings {
    std::uint32_t width = 640;
    std::uint32_t height = 480;
    int gain = 26;         ///< 0..63; 16 more is twice as bright
    int brightness = 0;    ///< -100..100, added to each channel
    int contrast = 100;    ///< %, about mid-grey
    int saturation = 100;  ///< %
    bool mirror = false;   ///< left and right changed over
    bool flip = false;     ///< top and bottom changed over
};

class Scenery {
  public:
    virtual ~Scenery() = default;

    /// Value `value` of signal `id` at the board's port `camera`.
    virtual void change(std::uint16_t id, double value) = 0;
    /// The picture of camera number `camera` at `instant`, after all changes up to then: rows from the top,
    /// red, green, blue of each pixel. `frame` counts the sensor's frames since power-up.
    virtual void render(std::size_t camera, const PictureSettings& settings, cosim::Time instant,
                        std::uint64_t frame, std::span<std::uint8_t> rgb) = 0;
};

}  // namespace puckloop::linuxboard
