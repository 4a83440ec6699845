#pragma once
// A picture that no test knows beforehand.

#include "base/random.h"
#include "emu/camera/pictures.h"

namespace puckloop::tests {

inline camera::Pixels random_pixels(RandomStream& random, std::uint32_t width, std::uint32_t height) {
    camera::Pixels pixels{width, height, std::vector<std::uint8_t>(3u * width * height)};
    for (std::uint8_t& level : pixels.rgb)
        level = static_cast<std::uint8_t>(random.below(256));
    return pixels;
}

/// Red, green and blue of a pixel as RGB565, the upper byte first.
inline std::array<std::uint8_t, 2> rgb565(const camera::Pixels& pixels, std::uint32_t x, std::uint32_t y) {
    const std::uint8_t* p = &pixels.rgb[3u * (y * pixels.width + x)];
    const unsigned word = p[0] / 8u * 2048u + p[1] / 4u * 32u + p[2] / 8u;
    return {static_cast<std::uint8_t>(word / 256), static_cast<std::uint8_t>(word % 256)};
}

}  // namespace puckloop::tests
