#pragma once
// The pixel formats and frame sizes of the cameras: what the e-puck's PO3030K and its like give (YUV 4:2:2,
// RGB 5:6:5, luminance), at VGA and below. All of the sensor's height is in each size; the narrower ones lose
// the same at both sides.

#include <cstdint>
#include <optional>
#include <span>

namespace puckloop::linuxboard {

struct VideoFormat {
    std::uint32_t fourcc;
    const char* description;
    std::uint32_t bytes;  ///< of a pixel
};
struct FrameSize {
    std::uint32_t width, height;
};

inline constexpr FrameSize kSensorSize{640, 480};
/// Frames a second that can be asked for; the sensor's own rate first.
inline constexpr std::uint32_t kFrameRates[] = {30, 15, 10, 5};

std::span<const VideoFormat> video_formats();
/// Largest first.
std::span<const FrameSize> frame_sizes();
const VideoFormat* find_format(std::uint32_t fourcc);
/// The size that differs least, as uvcvideo finds it: by the area that two pictures do not share.
FrameSize nearest_size(std::uint32_t width, std::uint32_t height);
/// The rate whose interval is nearest to so many seconds, as uvcvideo finds it; of two the longer interval.
/// Without a denominator the longest.
std::uint32_t nearest_rate(std::uint32_t numerator, std::uint32_t denominator);

/// `rgb` (3 bytes a pixel) as `format`, whose frame `out` has room for. YUV is full range (JPEG), the two
/// pixels of a pair share the mean of their colour.
void convert(const VideoFormat& format, std::span<const std::uint8_t> rgb, std::span<std::uint8_t> out);

/// Of a frame: FNV-1a, 64 bits, over its bytes taken as little-endian 64-bit words (the rest filled with
/// zeros).
std::uint64_t frame_hash(std::span<const std::uint8_t> frame);

}  // namespace puckloop::linuxboard
