// Coloured spots in pictures, found where they were drawn.

#include "linuxboard/control/behaviours/colour_blobs.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

using namespace puckloop::control;

namespace {

struct Picture {
    std::size_t width, height;
    std::vector<std::uint8_t> rgb;
    Picture(std::size_t w, std::size_t h, std::uint8_t grey) : width(w), height(h), rgb(w * h * 3, grey) {}
    void disc(double u, double v, double radius, std::array<int, 3> colour) {
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x)
                if (std::hypot(static_cast<double>(x) + 0.5 - u, static_cast<double>(y) + 0.5 - v) < radius)
                    for (std::size_t c = 0; c < 3; ++c)
                        rgb[(y * width + x) * 3 + c] = static_cast<std::uint8_t>(colour[c]);
    }
    std::vector<std::uint8_t> yuyv() const {
        std::vector<std::uint8_t> out(width * height * 2);
        for (std::size_t i = 0; i < width * height; i += 2) {
            double u = 0, v = 0;
            for (std::size_t k = 0; k < 2; ++k) {
                const double r = rgb[(i + k) * 3], g = rgb[(i + k) * 3 + 1], b = rgb[(i + k) * 3 + 2];
                out[(i + k) * 2] = static_cast<std::uint8_t>(std::lround(0.299 * r + 0.587 * g + 0.114 * b));
                u += (-0.168736 * r - 0.331264 * g + 0.5 * b) / 2;
                v += (0.5 * r - 0.418688 * g - 0.081312 * b) / 2;
            }
            out[i * 2 + 1] = static_cast<std::uint8_t>(std::clamp(std::lround(u) + 128, 0L, 255L));
            out[i * 2 + 3] = static_cast<std::uint8_t>(std::clamp(std::lround(v) + 128, 0L, 255L));
        }
        return out;
    }
};

}  // namespace

TEST_CASE("a coloured spot is found where it is drawn, in its colour only") {
    std::mt19937 random(61);
    const auto draw = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const std::pair<const char*, std::array<int, 3>> colours[] = {
        {"red", {230, 60, 50}}, {"green", {60, 230, 60}}, {"blue", {50, 60, 230}}};
    for (int i = 0; i < 60; ++i) {
        const bool large = i % 2 == 0;
        Picture picture(large ? 640 : 352, large ? 480 : 288, 110);
        const double scale = static_cast<double>(picture.height) / 288;
        const double angle = draw(-3.1, 3.1), radius = draw(45, 120);
        const double centre_u = static_cast<double>(picture.width) / 2 + 6 * scale;
        const double u = centre_u - radius * scale * std::cos(angle);
        const double v = (144 - radius * std::sin(angle)) * scale;
        const auto& [name, colour] = colours[i % 3];
        picture.disc(u, v, draw(2, 8), colour);
        // Outside the mirror nothing counts.
        picture.disc(centre_u + 145 * scale, 144 * scale, 4, colour);
        for (const auto& [other, unused] : colours) {
            const auto blobs =
                find_blobs(picture.yuyv(), picture.width, picture.height, *colour_named(other), {});
            if (std::string_view(other) != name) {
                CHECK(blobs.empty());
                continue;
            }
            REQUIRE(blobs.size() == 1);
            CHECK(std::abs(std::remainder(blobs[0].bearing - angle, 2 * std::numbers::pi)) < 0.03);
            CHECK(blobs[0].distance_cm == Approx(1.25455 * std::pow(1.03848, radius)).epsilon(0.05));
        }
    }
}

TEST_CASE("pixels that touch are one blob, whatever its shape, small ones do not count") {
    Picture picture(352, 288, 90);
    // A ring, which comes in pieces from row to row.
    picture.disc(200, 100, 20, {40, 220, 40});
    picture.disc(200, 100, 15, {90, 90, 90});
    picture.disc(120, 200, 6, {40, 220, 40});
    picture.disc(150.5, 220.5, 0.8, {40, 220, 40});
    const auto blobs = find_blobs(picture.yuyv(), 352, 288, *colour_named("green"), {});
    REQUIRE(blobs.size() == 2);
    CHECK(blobs[0].area > 400);
    CHECK(blobs[1].area == Approx(113).margin(20));
    CHECK(find_blobs({}, 352, 288, *colour_named("green"), {}).empty());
    CHECK_FALSE(colour_named("mauve"));
}
