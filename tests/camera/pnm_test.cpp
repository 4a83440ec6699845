// Picture files for the camera: the four kinds, and damaged ones.

#include "base/error.h"
#include "emu/camera/pictures.h"
#include "tests/camera/random_picture.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;

namespace {

std::string binary(const camera::Pixels& pixels) {
    std::string text = fmt::format("P6\n# drawn\n{} {}\n255\n", pixels.width, pixels.height);
    text.append(pixels.rgb.begin(), pixels.rgb.end());
    return text;
}

std::string plain(const camera::Pixels& pixels) {
    std::string text = fmt::format("P3 {}\t{} # drawn\n255", pixels.width, pixels.height);
    for (const std::uint8_t level : pixels.rgb)
        text += fmt::format("\n{}", level);
    return text;
}

}  // namespace

TEST_CASE("PPM and PGM pictures are read as they were written") {
    RandomStream random(3, "pnm");
    const camera::Pixels pixels = tests::random_pixels(random, 7, 5);
    CHECK(camera::read_pnm(binary(pixels), "x").rgb == pixels.rgb);
    CHECK(camera::read_pnm(plain(pixels), "x").rgb == pixels.rgb);
    const camera::Pixels grey = camera::read_pnm("P2 2 1 3 0 3", "x");
    CHECK(grey.rgb == std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255});
    const camera::Pixels wide = camera::read_pnm(std::string("P5 2 1 65535\n\xFF\xFF\x80\x00", 17), "x");
    CHECK(wide.rgb == std::vector<std::uint8_t>{255, 255, 255, 127, 127, 127});
}

TEST_CASE("a damaged picture is refused with its place, and never read beyond its end") {
    RandomStream random(4, "pnm");
    const camera::Pixels pixels = tests::random_pixels(random, 6, 4);
    int refused = 0;
    for (int i = 0; i < 4000; ++i) {
        std::string text = i % 2 ? binary(pixels) : plain(pixels);
        for (std::uint64_t hits = 1 + random.below(3); hits > 0; --hits)
            text[random.below(text.size())] = static_cast<char>(random.below(256));
        if (random.below(3) == 0) text.resize(random.below(text.size() + 1));
        try {
            const camera::Pixels read = camera::read_pnm(text, "x");
            CHECK(read.rgb.size() == 3u * read.width * read.height);
        } catch (const InputError& error) {
            ++refused;
            CHECK(std::string(error.what()).find("x: ") != std::string::npos);
        }
    }
    CHECK(refused > 1000);
    CHECK_THROWS_AS(camera::read_pnm("", "x"), InputError);
    CHECK_THROWS_AS(camera::read_pnm("P6 99999 1 255\n", "x"), InputError);
    CHECK_THROWS_AS(camera::read_pnm("P6 4096 4096 255\nshort", "x"), InputError);
    CHECK_THROWS_AS(camera::make_picture("/nowhere/at.ppm"), InputError);
}
