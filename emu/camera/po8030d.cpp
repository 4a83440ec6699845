// The PO8030D's registers, in banks A to C. Sources: names, values and bounds that the e-puck library's
// driver (fast_2_timer) writes; registers' names and the window's coordinates (from 1, of what comes out) as
// the e-puck2's and the Pi-puck's drivers use them.
//
// Deviations: 1. After a reset the registers hold a whole VGA picture in RGB565; frames are 776 x 516, the
// most that the library's driver allows for (18 a second at full speed). 2. What is scaled down comes in one
// go behind HREF, at the pixel clock that is set; the scaler's threshold, which moves it within its row, is
// kept.
// 3. The first row of colour comes 7 rows behind that of grey, as the two VSYNC settings of both drivers
// mean; the window's Y is kept, for the library never writes it. 4. Pads drive the lines whatever pad control
// states.
// 5. The sketch filter and the auto control's windows are kept and change nothing. 6. As po6030k.cpp, 4.

#include "emu/camera/model.h"

#include <algorithm>

namespace puckloop::camera {

namespace {

constexpr std::size_t kA = 0, kB = kBankSize, kC = 2 * kBankSize;
constexpr std::size_t kFrameWidth = kA + 0x04, kFrameHeight = kA + 0x06;  // two bytes each, the upper first
constexpr std::size_t kWindowX1 = kA + 0x08, kWindowY1 = kA + 0x0A, kWindowX2 = kA + 0x0C;
constexpr std::size_t kWindowY2 = kA + 0x0E, kVsyncStart = kA + 0x10, kVsyncStop = kA + 0x12;
constexpr std::size_t kRedGain = kA + 0x23, kClock = kA + 0x6A, kMirror = kA + 0x6C;
constexpr std::size_t kFormat = kB + 0x4E, kScaleX = kB + 0x93, kContrast = kB + 0x9D;
constexpr std::size_t kBrightness = kB + 0x9E, kSync = kB + 0xB7;
constexpr std::size_t kAutomatic = kC + 0x04, kExposure = kC + 0x12;  // four bytes

constexpr std::uint8_t kManualExposure = 0x01, kManualWhite = 0x04;
constexpr double kUnityGain = 0x40, kUnityContrast = 0x40;
constexpr double kDefaultExposure = 0x00080000;
constexpr std::uint32_t kArrayColumn = 68, kArrayRow = 4;  // the driver's origin
constexpr std::uint32_t kColourRows = 7;
constexpr std::uint32_t kTicksPerPixel = 2;

std::uint32_t word(const Registers& r, std::size_t at) {
    return static_cast<std::uint32_t>(r[at] << 8 | r[at + 1]);
}
void set_word(Registers& r, std::size_t at, std::uint32_t value) {
    r[at] = static_cast<std::uint8_t>(value >> 8);
    r[at + 1] = static_cast<std::uint8_t>(value);
}

/// Master clocks a tick.
std::uint32_t divider(std::uint8_t value) {
    switch (value) {
    case 0x02:
        return 2;
    case 0x04:
        return 4;
    case 0x05:
        return 8;
    default:
        return 1;
    }
}

PixelFormat format_of(std::uint8_t value) {
    constexpr std::uint8_t kYuv = 0x02, kGrey = 0x43, kGreyOnly = 0x44;  // either driver's grey
    if (value == kYuv) return PixelFormat::Yuv;
    return value == kGrey || value == kGreyOnly ? PixelFormat::Grey : PixelFormat::Rgb565;
}

void set_light(const Registers& r, VideoMode& mode) {
    constexpr int kNegative = 0x80;
    if (r[kAutomatic] & kManualExposure) {
        const double time =
            static_cast<double>(word(r, kExposure)) * 65536.0 + static_cast<double>(word(r, kExposure + 2));
        mode.gain.fill(time / kDefaultExposure);
    }
    mode.automatic.exposure = (r[kAutomatic] & kManualExposure) == 0;
    mode.automatic.white = (r[kAutomatic] & kManualWhite) == 0;
    if (r[kAutomatic] & kManualWhite)
        for (std::size_t c = 0; c < mode.gain.size(); ++c)
            mode.gain[c] *= r[kRedGain + c] / kUnityGain;
    const double magnitude = (r[kBrightness] & ~kNegative) / 256.0;
    mode.brightness = r[kBrightness] & kNegative ? -magnitude : magnitude;
    mode.contrast = r[kContrast] / kUnityContrast;
}

}  // namespace

Registers po8030d_defaults() {
    Registers r{};
    for (std::size_t bank = 0; bank < kBanks; ++bank) {
        r[bank * kBankSize] = 0x80;
        r[bank * kBankSize + 1] = 0x30;
    }
    set_word(r, kFrameWidth, 775);
    set_word(r, kFrameHeight, 515);
    set_word(r, kWindowX1, 1);
    set_word(r, kWindowY1, 1);
    set_word(r, kWindowX2, kArrayWidth);
    set_word(r, kWindowY2, kArrayHeight);
    set_word(r, kVsyncStart, kArrayRow + kColourRows - 1);
    set_word(r, kVsyncStop, kArrayRow + kColourRows + kArrayHeight);
    for (std::size_t c = 0; c < 3; ++c)
        r[kRedGain + c] = 0x40;
    r[kFormat] = 0x30;
    r[kScaleX] = r[kScaleX + 1] = 0x20;
    r[kContrast] = 0x40;
    r[kAutomatic] = 0x98;
    r[kExposure + 1] = 0x08;
    return r;
}

VideoMode po8030d_mode(const Registers& r) {
    VideoMode mode;
    mode.format = format_of(r[kFormat]);
    const std::uint32_t tick = divider(r[kClock]);
    mode.pixel_thirds = 3 * kTicksPerPixel * tick;
    mode.out_pixel_thirds = 3 * tick * (1 + (r[kSync] & 1u)) * mode.bytes_per_pixel();
    mode.step = r[kScaleX] == 0x80 ? 4 : r[kScaleX] == 0x40 ? 2 : 1;
    mode.frame_width = word(r, kFrameWidth) + 1;
    mode.frame_height = word(r, kFrameHeight) + 1;
    mode.array_column = kArrayColumn;
    mode.array_row = kArrayRow + (mode.format == PixelFormat::Grey ? 0 : kColourRows);
    // The window counts what comes out, from 1; beyond the array there is nothing.
    const auto column = [&](std::uint32_t out) {
        return kArrayColumn + std::min(out * mode.step, kArrayWidth);
    };
    mode.first_column = column(std::max(word(r, kWindowX1), 1u) - 1);
    mode.end_column = column(word(r, kWindowX2));
    mode.first_row = mode.array_row;
    mode.end_row = mode.array_row + kArrayHeight;
    mode.vsync_row = word(r, kVsyncStart);
    mode.vsync_end_row = word(r, kVsyncStop);
    mode.vsync_column = 1;
    // The library clears both bits: upright then.
    mode.mirror = (r[kMirror] & 0x40) != 0;
    mode.flip = (r[kMirror] & 0x80) != 0;
    set_light(r, mode);
    return mode;
}

}  // namespace puckloop::camera
