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

/// One that automatic exposure and white balance leave as it is: its mean is the reference that cameras start
/// with (112 of 255), and no pixel is nearly grey.
inline camera::Pixels settled_pixels(RandomStream& random, std::uint32_t width, std::uint32_t height) {
    camera::Pixels pixels{width, height, std::vector<std::uint8_t>(3u * width * height)};
    for (std::size_t i = 0; i < pixels.rgb.size(); i += 3) {
        const std::size_t dark = random.below(3);
        for (std::size_t c = 0; c < 3; ++c)
            pixels.rgb[i + c] =
                static_cast<std::uint8_t>(c == dark ? random.below(41) : 98 + random.below(121));
    }
    return pixels;
}

/// Red, green and blue of a pixel as RGB565, the upper byte first.
inline std::array<std::uint8_t, 2> rgb565(const camera::Pixels& pixels, std::uint32_t x, std::uint32_t y) {
    const std::uint8_t* p = &pixels.rgb[3u * (y * pixels.width + x)];
    const unsigned word = p[0] / 8u * 2048u + p[1] / 4u * 32u + p[2] / 8u;
    return {static_cast<std::uint8_t>(word / 256), static_cast<std::uint8_t>(word % 256)};
}

}  // namespace puckloop::tests
