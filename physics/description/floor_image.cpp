#include "physics/description/floor_image.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr std::size_t kMostPixels = 1 << 26;

[[noreturn]] void fail() {
    throw InputError("", "", "floor image: not a text that text() has written");
}

std::size_t number_of(std::string_view text, int base) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (error != std::errc{} || end != text.data() + text.size()) fail();
    return value;
}

std::size_t index_of(double share, std::size_t count) {
    const double place = std::floor(share * static_cast<double>(count));
    if (!(place > 0.0)) return 0;
    return std::min(static_cast<std::size_t>(std::min(place, 1e9)), count - 1);
}

}  // namespace

double grey_of(const Rgb& colour) {
    return (0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2]) / 255.0;
}

FloorImage::FloorImage(std::size_t width, std::vector<Rgb> pixels)
    : width_(width), pixels_(std::make_shared<const std::vector<Rgb>>(std::move(pixels))) {}

const Rgb& FloorImage::at(double right, double up) const {
    const std::size_t row = height() - 1 - index_of(up, height());
    return (*pixels_)[row * width_ + index_of(right, width_)];
}

std::string FloorImage::text() const {
    if (empty()) return {};
    std::string result = fmt::format("{}", width_);
    for (auto from = pixels_->begin(); from != pixels_->end();) {
        const auto to = std::find_if(from, pixels_->end(), [&](const Rgb& other) { return other != *from; });
        result += fmt::format(" {:02x}{:02x}{:02x}", (*from)[0], (*from)[1], (*from)[2]);
        if (to - from > 1) result += fmt::format("*{}", to - from);
        from = to;
    }
    return result;
}

FloorImage FloorImage::from_text(std::string_view text) {
    if (text.empty()) return {};
    const auto next = [&text] {
        const std::string_view word = text.substr(0, text.find(' '));
        text.remove_prefix(std::min(word.size() + 1, text.size()));
        return word;
    };
    const std::size_t width = number_of(next(), 10);
    std::vector<Rgb> pixels;
    while (!text.empty()) {
        const std::string_view run = next();
        if (run.size() < 6) fail();
        const std::size_t colour = number_of(run.substr(0, 6), 16);
        if (run.size() > 6 && run[6] != '*') fail();
        const std::size_t count = run.size() > 6 ? number_of(run.substr(7), 10) : 1;
        if (count > kMostPixels - pixels.size()) fail();
        pixels.insert(pixels.end(), count,
                      {static_cast<std::uint8_t>(colour >> 16), static_cast<std::uint8_t>(colour >> 8),
                       static_cast<std::uint8_t>(colour)});
    }
    if (width == 0 || pixels.empty() || pixels.size() % width != 0) fail();
    return {width, std::move(pixels)};
}

}  // namespace puckloop::physics
