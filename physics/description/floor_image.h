#pragma once
// A picture on the floor: red, green and blue of each pixel, 0..255, the first row the furthest from the
// viewer who stands at the patch's lower edge (+y of the patch). Never changed, so that copies share it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

using Rgb = std::array<std::uint8_t, 3>;

/// Luminance of ITU-R BT.601 (0.299, 0.587, 0.114), as pictures are turned grey: 0 black .. 1 white.
double grey_of(const Rgb& colour);

class FloorImage {
  public:
    FloorImage() = default;
    /// `pixels` row by row, `width` in each; its size must be a multiple of it.
    FloorImage(std::size_t width, std::vector<Rgb> pixels);

    bool empty() const { return !pixels_; }
    std::size_t width() const { return width_; }
    std::size_t height() const { return pixels_ ? pixels_->size() / width_ : 0; }

    /// The pixel at such shares of the picture's width (from its left) and height (from its lower edge up);
    /// what is outside is the nearest pixel. Not of an empty image.
    const Rgb& at(double right, double up) const;
    const std::vector<Rgb>& pixels() const { return *pixels_; }

    /// For descriptions that pass between processes: width, then runs "RRGGBB" or "RRGGBB*count", separated
    /// by spaces; "" of an empty one. from_text() throws InputError on anything else.
    std::string text() const;
    static FloorImage from_text(std::string_view text);

    friend bool operator==(const FloorImage& a, const FloorImage& b) {
        return a.width_ == b.width_ &&
               (a.pixels_ == b.pixels_ || (a.pixels_ && b.pixels_ && *a.pixels_ == *b.pixels_));
    }

  private:
    std::size_t width_ = 0;
    std::shared_ptr<const std::vector<Rgb>> pixels_;
};

}  // namespace puckloop::physics
