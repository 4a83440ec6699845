#include "scenarios/values/png_floor.h"

#include "base/error.h"

#include <fmt/format.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <vector>

namespace puckloop::scenarios {

namespace {

constexpr unsigned kMostPixels = 4096;  // a side

/// Frees what libpng holds of a file, however reading ends.
struct PngImage {
    png_image image{};
    PngImage() { image.version = PNG_IMAGE_VERSION; }
    ~PngImage() { png_image_free(&image); }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
};

}  // namespace

physics::FloorImage read_png(const std::filesystem::path& file) {
    const auto fail = [&](const std::string& problem) {
        throw InputError(file.string(), "", problem, "a PNG file of at most 4096 x 4096 pixels");
    };
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) fail("there is no such file");
    PngImage png;
    if (png_image_begin_read_from_file(&png.image, file.c_str()) == 0)
        fail(fmt::format("cannot be read as PNG: {}", png.image.message));
    if (png.image.width > kMostPixels || png.image.height > kMostPixels)
        fail(fmt::format("has {} x {} pixels", png.image.width, png.image.height));
    png.image.format = PNG_FORMAT_RGB;
    png.image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // as pictures are, not linear
    std::vector<physics::Rgb> pixels(std::size_t{png.image.width} * png.image.height);
    const png_color white{255, 255, 255};
    static_assert(sizeof(physics::Rgb) == 3);
    const unsigned width = png.image.width;
    if (png_image_finish_read(&png.image, &white, pixels.data(), 0, nullptr) == 0)
        fail(fmt::format("cannot be read as PNG: {}", png.image.message));
    return {width, std::move(pixels)};
}

std::string misfit_of(const physics::FloorImage& image, double length, double width) {
    constexpr double kMost = 0.02;
    const double along = length / static_cast<double>(image.width());
    const double across = width / static_cast<double>(image.height());
    if (std::abs(along / across - 1.0) <= kMost) return {};
    return fmt::format(
        "an image of {} x {} pixels on {:.4g} m x {:.4g} m: its pixels are {:.3g} mm long and {:.3g} mm wide",
        image.width(), image.height(), length, width, along * 1e3, across * 1e3);
}

}  // namespace puckloop::scenarios
