// The camera's lines: the next edge that is foretold is the one that comes, found by looking at every cycle.

#include "emu/camera/video_timing.h"

#include "base/random.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using camera::Cycle;
using camera::PixelFormat;
using camera::VideoMode;
using camera::VideoTiming;

namespace {

/// A small frame, so that all of it can be looked at.
VideoMode drawn_mode(RandomStream& random) {
    constexpr std::uint32_t kThirds[] = {6, 8, 12, 24};
    constexpr std::uint32_t kSteps[] = {1, 2, 4};
    const auto below = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random.below(most)); };
    VideoMode mode;
    mode.pixel_thirds = kThirds[below(4)];
    mode.step = kSteps[below(3)];
    mode.frame_width = 20 + below(30);
    mode.frame_height = 8 + below(12);
    mode.first_column = below(mode.frame_width);
    mode.end_column = mode.first_column + below(60);
    mode.first_row = below(mode.frame_height);
    mode.end_row = mode.first_row + below(20);
    mode.vsync_row = below(mode.frame_height + 2);
    mode.vsync_end_row = mode.vsync_row + below(mode.frame_height);
    mode.vsync_column = below(mode.frame_width);
    mode.format = static_cast<PixelFormat>(below(3));
    return mode;
}

}  // namespace

TEST_CASE("the edge that a camera foretells is the one that comes") {
    RandomStream random(11, "camera timing");
    int edges = 0, bytes = 0;
    for (int draw = 0; draw < 40; ++draw) {
        const VideoMode mode = drawn_mode(random);
        const Cycle start = random.below(1000);
        const VideoTiming timing(mode, start);
        CAPTURE(draw, mode.pixel_thirds, mode.step, mode.first_column, mode.end_column, mode.vsync_row);
        const Cycle frame = (mode.frame_width * mode.frame_height * mode.pixel_thirds + 2) / 3;
        Cycle vsync = timing.next_vsync(start), href = timing.next_href(start),
              byte = timing.next_byte(start);
        for (Cycle now = start + 1; now < start + 2 * frame + 100; ++now) {
            if (timing.vsync(now) != timing.vsync(now - 1)) {
                REQUIRE(vsync == now);
                ++edges;
            }
            if (timing.href(now) != timing.href(now - 1)) {
                REQUIRE(href == now);
                ++edges;
            }
            const auto at = timing.place(now), before = timing.place(now - 1);
            const bool same = at.has_value() == before.has_value() &&
                              (!at || (at->pixel == before->pixel && at->byte == before->byte));
            // Where HREF changes the data do, too; that edge has its own time.
            if ((!same && timing.href(now) == timing.href(now - 1)) ||
                timing.pclk(now) != timing.pclk(now - 1)) {
                REQUIRE(byte == now);
                ++bytes;
            }
            if (vsync == now) vsync = timing.next_vsync(now);
            if (href == now) href = timing.next_href(now);
            if (byte == now) byte = timing.next_byte(now);
            REQUIRE((vsync > now && href > now && byte > now));
        }
    }
    CHECK(edges > 300);
    CHECK(bytes > 3000);
}

TEST_CASE("the library's modes put out a byte every eight cycles, and the frames that it was written for") {
    // Colour: 16, 8, 4 clocks a pixel with step 1, 2, 4; grey half of that.
    for (const std::uint32_t step : {1u, 2u, 4u})
        for (const PixelFormat format : {PixelFormat::Rgb565, PixelFormat::Grey}) {
            VideoMode mode;
            mode.step = step;
            mode.format = format;
            mode.pixel_thirds = 3 * (format == PixelFormat::Grey ? 8 : 16) / step;
            const VideoTiming timing(mode, 0);
            const Cycle rise = timing.next_href(0);
            REQUIRE(timing.href(rise));
            REQUIRE_FALSE(timing.href(rise - 1));
            // The library's routine reads 15 cycles behind the edge and every eighth from then on: always in
            // the same half of a byte, and every byte once.
            for (std::uint32_t i = 0; i + 3 < 640 / step * mode.bytes_per_pixel(); ++i) {
                const auto place = timing.place(rise + 15 + 8 * i);
                REQUIRE(place);
                CHECK(place->pixel * mode.bytes_per_pixel() + place->byte == i + 2);
                for (const int jitter : {-2, 3}) {
                    const auto near = timing.place(rise + 15 + 8 * i + static_cast<Cycle>(jitter));
                    REQUIRE(near);
                    CHECK(near->pixel == place->pixel);
                    CHECK(near->byte == place->byte);
                }
            }
        }
}
