#include "emu/camera/pictures.h"

#include "base/error.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>

namespace puckloop::camera {

namespace {

constexpr std::uint32_t kLargest = 4096, kDeepest = 65535;

class TestPattern final : public Scenery {
  public:
    void render(std::uint32_t width, std::uint32_t height, std::uint64_t,
                std::span<std::uint8_t> rgb) override {
        constexpr std::uint32_t kBars = 8, kSquare = 16;  // a sixteenth of the width
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                std::uint8_t* pixel = &rgb[3u * (y * width + x)];
                if (x < width / kSquare && y < width / kSquare) {
                    pixel[0] = pixel[1] = pixel[2] = 0xFF;
                } else if (4 * y < 3 * height) {
                    const std::uint32_t off = x * kBars / width;  // bit 2: no green, 1: no red, 0: no blue
                    pixel[0] = off & 2 ? 0 : 0xC0;
                    pixel[1] = off & 4 ? 0 : 0xC0;
                    pixel[2] = off & 1 ? 0 : 0xC0;
                } else {
                    pixel[0] = pixel[1] = pixel[2] = static_cast<std::uint8_t>(x * 0xFF / (width - 1));
                }
            }
    }
};

class FixedPicture final : public Scenery {
  public:
    explicit FixedPicture(Pixels pixels) : pixels_(std::move(pixels)) {}
    void render(std::uint32_t width, std::uint32_t height, std::uint64_t,
                std::span<std::uint8_t> rgb) override {
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                // The pixel under the middle.
                const std::uint32_t from_x = (2 * x + 1) * pixels_.width / (2 * width);
                const std::uint32_t from_y = (2 * y + 1) * pixels_.height / (2 * height);
                for (std::uint32_t c = 0; c < 3; ++c)
                    rgb[3u * (y * width + x) + c] = pixels_.rgb[3u * (from_y * pixels_.width + from_x) + c];
            }
    }

  private:
    Pixels pixels_;
};

class PnmReader {
  public:
    PnmReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    Pixels read() {
        if (bytes_.size() < 2 || bytes_[0] != 'P' || std::string_view("2356").find(bytes_[1]) > 3)
            fail("header", "no PGM or PPM picture", "P2, P3, P5 or P6");
        const char kind = bytes_[1];
        at_ = 2;
        const bool colour = kind == '3' || kind == '6', plain = kind == '2' || kind == '3';
        Pixels pixels;
        pixels.width = number("width", 1, kLargest);
        pixels.height = number("height", 1, kLargest);
        const std::uint32_t most = number("largest value", 1, kDeepest);
        if (!plain) ++at_;  // one blank behind the header
        const std::size_t count = std::size_t{pixels.width} * pixels.height * (colour ? 3 : 1);
        const std::size_t wide = most > 0xFF ? 2 : 1;
        const std::size_t left = bytes_.size() - std::min(at_, bytes_.size());
        if (plain ? 2 * count > left + 1 : count * wide > left)
            fail("pixels",
                 fmt::format("the file is too short for {} x {} pixels", pixels.width, pixels.height),
                 "a whole picture");
        pixels.rgb.reserve(std::size_t{pixels.width} * pixels.height * 3);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t value = plain ? number("pixel", 0, most) : binary(wide);
            const auto level = static_cast<std::uint8_t>(std::min(value, most) * 0xFFu / most);
            pixels.rgb.insert(pixels.rgb.end(), colour ? 1 : 3, level);
        }
        return pixels;
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& what, const std::string& expected) {
        throw InputError(name_, place, what, expected);
    }
    std::uint32_t binary(std::size_t wide) {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < wide; ++i)
            value = value << 8 | static_cast<std::uint8_t>(bytes_[at_++]);
        return value;
    }
    std::uint32_t number(const char* what, std::uint32_t least, std::uint32_t most) {
        for (; at_ < bytes_.size(); ++at_) {
            if (bytes_[at_] == '#')
                at_ = std::min(bytes_.find('\n', at_), bytes_.size() - 1);
            else if (std::string_view(" \t\r\n\v\f").find(bytes_[at_]) == std::string_view::npos)
                break;
        }
        std::uint32_t value = 0;
        const char* const end = bytes_.data() + bytes_.size();
        const auto [stop, error] = std::from_chars(bytes_.data() + at_, end, value);
        if (error != std::errc{} || value < least || value > most)
            fail(what, fmt::format("no {} at byte {}", what, at_), fmt::format("{} to {}", least, most));
        at_ = static_cast<std::size_t>(stop - bytes_.data());
        return value;
    }

    std::string_view bytes_;
    const std::string& name_;
    std::size_t at_ = 0;
};

}  // namespace

std::unique_ptr<Scenery> make_test_pattern() {
    return std::make_unique<TestPattern>();
}

Pixels read_pnm(std::string_view bytes, const std::string& name) {
    return PnmReader(bytes, name).read();
}

std::unique_ptr<Scenery> make_picture(Pixels pixels) {
    return std::make_unique<FixedPicture>(std::move(pixels));
}

std::unique_ptr<Scenery> make_picture(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw InputError(file, "", "cannot be read", "a PGM or PPM picture");
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    return make_picture(read_pnm(bytes, file));
}

}  // namespace puckloop::camera
