#include "emu/tam_avr/fuse_check.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tam {

namespace {

constexpr std::uint32_t kFlashBytes = 128 * 1024;
constexpr unsigned kClockSelect = 0x0F,
                   kLowestCrystal = 0x06;  // below: RC oscillators, external clock, watch crystal
constexpr unsigned kClockOutput = 0x40;    // CKOUT, programmed = 0
constexpr unsigned kSpiEnable = 0x20;      // SPIEN
constexpr unsigned kBrownOut = 0x07, kNoBrownOut = 0x07, kBrownOut4V3 = 0x04;

}  // namespace

std::vector<std::string> fuse_warnings(const avr::Fuses& fuses, const image::AvrImage& image) {
    std::vector<std::string> lines;
    const auto wrong = [&](const char* which, unsigned byte, unsigned usual, const char* effect) {
        lines.push_back(
            fmt::format("fuse {} is 0x{:02X} (expected 0x{:02X}): {}", which, byte, usual, effect));
    };
    constexpr unsigned kLow = 0xFF, kHigh = 0xDE, kExtended = 0xFD;
    if (fuses.divide_clock()) wrong("low", fuses.low, kLow, "CKDIV8 divides the clock by 8");
    if ((fuses.low & kClockSelect) < kLowestCrystal)
        wrong("low", fuses.low, kLow, "CKSEL selects a clock that is not the board's resonator");
    if ((fuses.low & kClockOutput) == 0) wrong("low", fuses.low, kLow, "CKOUT drives the clock out of PB1");
    if (fuses.jtag())
        wrong("high", fuses.high, kHigh, "JTAGEN takes PC2 to PC5, the module's RTS and the LED");
    if ((fuses.high & kSpiEnable) != 0)
        wrong("high", fuses.high, kHigh, "SPIEN is off: a programmer finds nobody");
    if (fuses.watchdog_always())
        wrong("high", fuses.high, kHigh, "WDTON keeps the watchdog on, which the firmware must then serve");
    if ((fuses.extended & kBrownOut) == kNoBrownOut)
        wrong("extended", fuses.extended, kExtended, "the brown-out detector is off");
    if ((fuses.extended & kBrownOut) == kBrownOut4V3)
        wrong("extended", fuses.extended, kExtended,
              "the brown-out level of 4.3 V is above the supply, which holds the board in reset");
    const std::uint32_t reset = fuses.boot_reset() ? kFlashBytes - 2 * fuses.boot_words() : 0;
    const bool something =
        std::any_of(image.flash.begin(), image.flash.end(), [&](const image::ByteSegment& segment) {
            return reset >= segment.address && reset < segment.address + segment.bytes.size();
        });
    if (!something)
        lines.push_back(fmt::format("nothing is at 0x{:05X}, where a reset leads with fuse high 0x{:02X}",
                                    reset, fuses.high));
    return lines;
}

}  // namespace puckloop::tam
