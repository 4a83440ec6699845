// The PO3030K's registers. Names and values: the tables of the e-puck library's driver (fast_2_timer).
//
// Deviations: 1. After a reset the registers hold what that driver's table holds, but for the speed. 2. Edge
// enhancement, gamma, colour matrix, lens shading, flicker and weighting windows are kept and change nothing.
// 3. Registers do not show what automatic exposure and white balance (automatic.h) have come to.

#include "emu/camera/model.h"

#include <utility>

namespace puckloop::camera {

namespace {

constexpr std::uint8_t kIdHigh = 0x00, kIdLow = 0x01;
constexpr std::uint8_t kFrameWidth = 0x04, kFrameHeight = 0x06;  // two bytes each, the upper one first
constexpr std::uint8_t kWindowX1 = 0x08, kWindowY1 = 0x0A, kWindowX2 = 0x0C, kWindowY2 = 0x0E;
constexpr std::uint8_t kGlobalGain = 0x15, kRedGain = 0x16, kGreenGain = 0x17, kBlueGain = 0x18;
constexpr std::uint8_t kSpeed = 0x1D, kMirror = 0x1E, kSampling = 0x20, kOutput = 0x4E;
constexpr std::uint8_t kBrightness = 0x9B, kContrast = 0x9C;
constexpr std::uint8_t kVsyncStart = 0xA5, kVsyncStop = 0xA7, kVsyncColumn = 0xA9;
constexpr std::uint8_t kExposure = 0xB0;  // three bytes
constexpr std::uint8_t kMargin = 0xAE, kAutomaticSpeed = 0xAF, kReference = 0xB3;
constexpr std::uint8_t kLongest = 0xBB, kShortest = 0xBD;  // exposure: the upper two bytes of three
constexpr std::uint8_t kLeastRed = 0xC1, kMostRed = 0xC2, kLeastBlue = 0xC3, kMostBlue = 0xC4;
constexpr std::uint8_t kAutomatic = 0xD4;

constexpr std::uint8_t kDefaultContrast = 0x96, kDefaultReference = 0x70, kDefaultGain = 0x10;
constexpr double kDefaultExposure = 0x07CC00;
constexpr std::uint8_t kAutomaticExposure = 0x10, kAutomaticWhite = 0x20;
constexpr double kUnityGain = 0x40;    // [2:6] fixed point
constexpr double kGainDoubles = 16.0;  // steps of the global gain
constexpr std::uint32_t kArrayColumn = 210, kArrayRow = 7;

std::uint32_t word(const Registers& r, std::uint8_t at) {
    return static_cast<std::uint32_t>(r[at] << 8 | r[at + 1u]);
}

/// Master clocks a pixel, in thirds, by the upper half of register 0x1D.
std::uint32_t pixel_thirds(std::uint8_t speed) {
    constexpr std::uint32_t kThirds[] = {3 * 2, 8, 3 * 4, 3 * 8, 3 * 16, 3 * 32, 3 * 64, 3 * 128};
    return kThirds[speed >> 4 & 7];
}

std::uint32_t step_of(std::uint8_t sampling) {
    return sampling == 0x33 ? 4 : sampling == 0x11 ? 2 : 1;
}

void set_automatic(const Registers& r, AutomaticSettings& automatic) {
    constexpr double kFullScale = 255.0, kSixteenth = 16.0, kDefaultLongest = kDefaultExposure / 256.0;
    constexpr double kLargestAnalogGain = 4.0;
    automatic.exposure = (r[kAutomatic] & kAutomaticExposure) != 0;
    automatic.white = (r[kAutomatic] & kAutomaticWhite) != 0;
    automatic.reference = r[kReference] / kFullScale;
    automatic.margin = (r[kMargin] & 0x0F) / kFullScale;
    automatic.rise = (r[kAutomaticSpeed] >> 4) / kSixteenth;
    automatic.fall = (r[kAutomaticSpeed] & 0x0F) / kSixteenth;
    automatic.least = word(r, kShortest) / kDefaultLongest;
    automatic.most = word(r, kLongest) / kDefaultLongest * kLargestAnalogGain;
    automatic.white_least = {r[kLeastRed] / kUnityGain, r[kLeastBlue] / kUnityGain};
    automatic.white_most = {r[kMostRed] / kUnityGain, r[kMostBlue] / kUnityGain};
}

void set_exposure(const Registers& r, VideoMode& mode) {
    if (!(r[kAutomatic] & kAutomaticExposure)) {
        const double time =
            (r[kExposure] << 16 | r[kExposure + 1u] << 8 | r[kExposure + 2u]) / kDefaultExposure;
        const double steps = static_cast<double>(r[kGlobalGain]) - kDefaultGain;
        for (double& gain : mode.gain)
            gain = time * (1.0 + steps / kGainDoubles);
    }
    if (!(r[kAutomatic] & kAutomaticWhite)) {
        mode.gain[0] *= r[kRedGain] / kUnityGain;
        mode.gain[1] *= r[kGreenGain] / kUnityGain;
        mode.gain[2] *= r[kBlueGain] / kUnityGain;
    }
    const auto signed_part = static_cast<std::int8_t>(r[kBrightness]);
    mode.brightness = signed_part / 256.0;
    mode.contrast = r[kContrast] / static_cast<double>(kDefaultContrast);
}

}  // namespace

Registers po3030k_defaults() {
    Registers r{};
    constexpr std::pair<std::uint8_t, std::uint8_t> kTable[] = {{kIdHigh, 0x30},
                                                                {kIdLow, 0x30},
                                                                {kFrameWidth, 0x03},
                                                                {kFrameWidth + 1, 0x53},
                                                                {kFrameHeight, 0x01},
                                                                {kFrameHeight + 1, 0xE8},
                                                                {kWindowX1 + 1, 0xD1},
                                                                {kWindowY1 + 1, 0x07},
                                                                {kWindowX2, 0x03},
                                                                {kWindowX2 + 1, 0x51},
                                                                {kWindowY2, 0x01},
                                                                {kWindowY2 + 1, 0xE7},
                                                                {kGlobalGain, kDefaultGain},
                                                                {kRedGain, 0x40},
                                                                {kGreenGain, 0x40},
                                                                {kBlueGain, 0x40},
                                                                {0x19, 0x40},
                                                                {kSpeed, 0x00},
                                                                {kMirror, 0x0A},
                                                                {0x1F, 0x1B},
                                                                {kSampling, 0x44},
                                                                {kOutput, 0x08},
                                                                {kContrast, kDefaultContrast},
                                                                {kVsyncStart + 1, 0x07},
                                                                {kVsyncStop, 0x01},
                                                                {kVsyncStop + 1, 0xE7},
                                                                {kVsyncColumn + 1, 0x01},
                                                                {kMargin, 0x22},
                                                                {kAutomaticSpeed, 0x8C},
                                                                {kExposure, 0x07},
                                                                {kExposure + 1, 0xCC},
                                                                {kReference, kDefaultReference},
                                                                {kLongest, 0x07},
                                                                {kLongest + 1, 0xCC},
                                                                {kShortest + 1, 0x0C},
                                                                {kLeastRed, 0x10},
                                                                {kMostRed, 0xE0},
                                                                {kLeastBlue, 0x10},
                                                                {kMostBlue, 0xE0},
                                                                {kAutomatic, 0x3C},
                                                                {0xD5, 0x01}};
    for (const auto& [at, value] : kTable)
        r[at] = value;
    return r;
}

VideoMode po3030k_mode(const Registers& r) {
    VideoMode mode;
    mode.pixel_thirds = pixel_thirds(r[kSpeed]);
    mode.step = step_of(r[kSampling]);
    mode.frame_width = word(r, kFrameWidth) + 1;
    mode.frame_height = word(r, kFrameHeight) + 1;
    mode.first_column = word(r, kWindowX1) + 1;
    mode.end_column = word(r, kWindowX2) + 1;
    mode.first_row = word(r, kWindowY1);
    mode.end_row = word(r, kWindowY2);
    mode.array_column = kArrayColumn;
    mode.array_row = kArrayRow;
    mode.vsync_row = word(r, kVsyncStart);
    mode.vsync_end_row = word(r, kVsyncStop);
    mode.vsync_column = word(r, kVsyncColumn);
    constexpr std::uint8_t kYuv = 0x02, kGrey = 0x0C;
    mode.format = r[kOutput] == kGrey  ? PixelFormat::Grey
                  : r[kOutput] == kYuv ? PixelFormat::Yuv
                                       : PixelFormat::Rgb565;
    // The board carries it the other way up: with both bits set, as programs do, the picture is upright.
    mode.mirror = !(r[kMirror] & 0x80);
    mode.flip = !(r[kMirror] & 0x40);
    set_exposure(r, mode);
    set_automatic(r, mode.automatic);
    return mode;
}

}  // namespace puckloop::camera
