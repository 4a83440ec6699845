// The PO6030K's registers, in banks A to C. Names and values: what the e-puck library's driver writes.
//
// Deviations: 1. After a reset the registers hold a whole VGA picture in RGB565; frames are 800 x 500, the
// most that the driver allows for. 2. Rows that come out are fixed; VSYNC rises one pixel behind HREF, as the
// library sets it for the PO3030K. 3. The sketch filter is kept and changes nothing. 4. As po3030k.cpp,
// 3; reference, speeds and bounds are those of the PO3030K.

#include "emu/camera/model.h"

namespace puckloop::camera {

namespace {

constexpr std::size_t kA = 0, kB = kBankSize, kC = 2 * kBankSize;
constexpr std::size_t kMirror = kA + 0x90, kBayerClock = kA + 0x91;
constexpr std::size_t kOutput = kB + 0x38, kWindowX1 = kB + 0x50, kWindowX2 = kB + 0x54;
constexpr std::size_t kVsyncStart = kB + 0x60, kVsyncStop = kB + 0x62;
constexpr std::size_t kScaleX = kB + 0x80;
constexpr std::size_t kAutomatic = kC + 0x04, kExposure = kC + 0x2C, kRedGain = kC + 0xA4;

constexpr std::uint8_t kManualExposure = 0x01, kManualWhite = 0x04;
constexpr double kUnityGain = 0x40;
constexpr double kDefaultExposure = 0x00080000;
constexpr std::uint32_t kFrameWidth = 800, kFrameHeight = 500, kArrayRow = 8;
constexpr std::uint32_t kArrayColumn = 16;  // in the window's coordinates, at full sampling
constexpr std::uint32_t kTicksPerPixel = 2;

std::uint32_t word(const Registers& r, std::size_t at) {
    return static_cast<std::uint32_t>(r[at] << 8 | r[at + 1]);
}

/// Master clocks a tick of the Bayer clock.
std::uint32_t bayer_clock(std::uint8_t value) {
    switch (value) {
    case 0x10:
        return 1;
    case 0x50:
        return 2;
    case 0x90:
        return 4;
    default:
        return 8;
    }
}

}  // namespace

Registers po6030k_defaults() {
    Registers r{};
    for (std::size_t bank = 0; bank < kBanks; ++bank) {
        r[bank * kBankSize] = 0x60;
        r[bank * kBankSize + 1] = 0x30;
    }
    r[kBayerClock] = 0xB0;
    r[kOutput] = 0x08;
    r[kWindowX1 + 1] = kArrayColumn - 1;
    r[kWindowX2] = (kArrayColumn + kArrayWidth) >> 8;
    r[kWindowX2 + 1] = (kArrayColumn + kArrayWidth) & 0xFF;
    r[kVsyncStart + 1] = kArrayRow;
    r[kVsyncStop] = (kArrayRow + kArrayHeight) >> 8;
    r[kVsyncStop + 1] = (kArrayRow + kArrayHeight) & 0xFF;
    r[kScaleX] = r[kScaleX + 1] = 0x20;
    r[kAutomatic] = 0x98;
    r[kExposure + 1] = 0x08;
    r[kRedGain] = r[kRedGain + 1] = r[kRedGain + 2] = 0x40;
    return r;
}

VideoMode po6030k_mode(const Registers& r) {
    VideoMode mode;
    const std::uint32_t tick = bayer_clock(r[kBayerClock]);
    mode.pixel_thirds = 3 * kTicksPerPixel * tick;
    mode.step = r[kScaleX] == 0x80 ? 4 : r[kScaleX] == 0x40 ? 2 : 1;
    mode.frame_width = kFrameWidth;
    mode.frame_height = kFrameHeight;
    // The window is in pixels that come out; the array begins at column 16 of all.
    mode.first_column = (word(r, kWindowX1) + 1) * mode.step;
    mode.array_column = kArrayColumn;
    mode.end_column = kArrayColumn + kArrayWidth;
    mode.first_row = kArrayRow;
    mode.array_row = kArrayRow;
    mode.end_row = kArrayRow + kArrayHeight;
    mode.vsync_row = word(r, kVsyncStart);
    mode.vsync_end_row = word(r, kVsyncStop);
    mode.vsync_column = mode.first_column + 1;
    constexpr std::uint8_t kGrey = 0x0D, kYuv = 0x02;
    mode.format = r[kOutput] == kGrey  ? PixelFormat::Grey
                  : r[kOutput] == kYuv ? PixelFormat::Yuv
                                       : PixelFormat::Rgb565;
    // The board carries it the other way up: with both bits set the picture is upright.
    mode.mirror = !(r[kMirror] & 0x40);
    mode.flip = !(r[kMirror] & 0x80);
    if (r[kAutomatic] & kManualExposure) {
        const double time =
            static_cast<double>(word(r, kExposure)) * 65536.0 + static_cast<double>(word(r, kExposure + 2));
        for (double& gain : mode.gain)
            gain = time / kDefaultExposure;
    }
    mode.automatic.exposure = (r[kAutomatic] & kManualExposure) == 0;
    mode.automatic.white = (r[kAutomatic] & kManualWhite) == 0;
    if (r[kAutomatic] & kManualWhite)
        for (std::size_t c = 0; c < mode.gain.size(); ++c)
            mode.gain[c] *= r[kRedGain + c] / kUnityGain;
    return mode;
}

}  // namespace puckloop::camera
