#include "linuxboard/shim/devices/video_formats.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace puckloop::linuxboard {

namespace {

constexpr std::array<VideoFormat, 4> kFormats{{
    {V4L2_PIX_FMT_YUYV, "YUYV 4:2:2", 2},
    {V4L2_PIX_FMT_UYVY, "UYVY 4:2:2", 2},
    {V4L2_PIX_FMT_RGB565, "16-bit RGB 5-6-5", 2},
    {V4L2_PIX_FMT_GREY, "8-bit Greyscale", 1},
}};
constexpr std::array<FrameSize, 5> kSizes{{{640, 480}, {352, 288}, {320, 240}, {176, 144}, {160, 120}}};

constexpr int kFraction = 16;  // bits
constexpr int kHalf = 1 << (kFraction - 1);
constexpr int kMiddle = 128;

constexpr int fixed(double value) {
    return static_cast<int>(value * (1 << kFraction) + (value < 0 ? -0.5 : 0.5));
}

std::uint8_t byte_of(int value) {
    return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

/// ITU-R BT.601, full range.
int luminance(const std::uint8_t* p) {
    return (fixed(0.299) * p[0] + fixed(0.587) * p[1] + fixed(0.114) * p[2] + kHalf) >> kFraction;
}
/// Of the sum of two pixels.
std::uint8_t blue_of(int r, int g, int b) {
    const int sum = fixed(-0.168736) * r + fixed(-0.331264) * g + fixed(0.5) * b;
    return byte_of(((sum + (1 << kFraction)) >> (kFraction + 1)) + kMiddle);
}
std::uint8_t red_of(int r, int g, int b) {
    const int sum = fixed(0.5) * r + fixed(-0.418688) * g + fixed(-0.081312) * b;
    return byte_of(((sum + (1 << kFraction)) >> (kFraction + 1)) + kMiddle);
}

/// `luma` and `chroma`: places of the first luminance and the first colour byte among each four.
void to_yuv(std::span<const std::uint8_t> rgb, std::uint8_t* out, std::size_t luma, std::size_t chroma) {
    for (std::size_t i = 0; i + 6 <= rgb.size(); i += 6, out += 4) {
        const std::uint8_t* p = rgb.data() + i;
        const int r = p[0] + p[3];
        const int g = p[1] + p[4];
        const int b = p[2] + p[5];
        out[luma] = byte_of(luminance(p));
        out[luma + 2] = byte_of(luminance(p + 3));
        out[chroma] = blue_of(r, g, b);
        out[chroma + 2] = red_of(r, g, b);
    }
}

}  // namespace

std::span<const VideoFormat> video_formats() {
    return kFormats;
}
std::span<const FrameSize> frame_sizes() {
    return kSizes;
}

const VideoFormat* find_format(std::uint32_t fourcc) {
    const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                    [fourcc](const VideoFormat& format) { return format.fourcc == fourcc; });
    return found == kFormats.end() ? nullptr : &*found;
}

FrameSize nearest_size(std::uint32_t width, std::uint32_t height) {
    const auto off = [width = width & 0xFFFF, height = height & 0xFFFF](const FrameSize& size) {
        const std::uint32_t common = std::min(size.width, width) * std::min(size.height, height);
        return size.width * size.height + width * height - 2 * common;
    };
    return *std::min_element(kSizes.begin(), kSizes.end(),
                             [&](const FrameSize& a, const FrameSize& b) { return off(a) < off(b); });
}

std::uint32_t nearest_rate(std::uint32_t numerator, std::uint32_t denominator) {
    constexpr std::uint64_t kSecond = 10'000'000;  // uvcvideo counts 100 ns
    const std::uint64_t wanted = denominator == 0 ? ~std::uint32_t{0} : numerator * kSecond / denominator;
    std::uint32_t nearest = kFrameRates[0];
    std::uint64_t least = ~std::uint64_t{0};
    for (const std::uint32_t rate : kFrameRates) {
        const std::uint64_t interval = kSecond / rate;
        const std::uint64_t off = std::max(wanted, interval) - std::min(wanted, interval);
        if (off > least) break;
        least = off;
        nearest = rate;
    }
    return nearest;
}

void convert(const VideoFormat& format, std::span<const std::uint8_t> rgb, std::span<std::uint8_t> out) {
    switch (format.fourcc) {
    case V4L2_PIX_FMT_YUYV:
        return to_yuv(rgb, out.data(), 0, 1);
    case V4L2_PIX_FMT_UYVY:
        return to_yuv(rgb, out.data(), 1, 0);
    case V4L2_PIX_FMT_RGB565:
        for (std::size_t i = 0, o = 0; i + 3 <= rgb.size(); i += 3, o += 2) {
            const int word = (rgb[i] >> 3) << 11 | (rgb[i + 1] >> 2) << 5 | rgb[i + 2] >> 3;
            out[o] = static_cast<std::uint8_t>(word & 0xff);
            out[o + 1] = static_cast<std::uint8_t>(word >> 8);
        }
        return;
    default:
        for (std::size_t i = 0, o = 0; i + 3 <= rgb.size(); i += 3, ++o)
            out[o] = byte_of(luminance(rgb.data() + i));
    }
}

std::uint64_t frame_hash(std::span<const std::uint8_t> frame) {
    constexpr std::uint64_t kBasis = 0xcbf29ce484222325;
    constexpr std::uint64_t kPrime = 0x100000001b3;
    std::uint64_t hash = kBasis;
    for (std::size_t i = 0; i < frame.size(); i += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, frame.data() + i, std::min(sizeof word, frame.size() - i));
        hash = (hash ^ word) * kPrime;
    }
    return hash;
}

}  // namespace puckloop::linuxboard
