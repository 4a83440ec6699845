#include "emu/pic/si3000.h"

#include <algorithm>
#include <cmath>

namespace puckloop::pic {

namespace {

enum Register : std::size_t {
    kControl1 = 1,
    kControl2 = 2,
    kPllN = 3,
    kPllM = 4,
    kRxGain = 5,
    kAdcVolume = 6,
    kDacVolume = 7,
    kStatus = 8,
    kAttenuation = 9
};

// Control 1
constexpr unsigned kSoftReset = 0x80, kSpeakerPower = 0x10, kChipPowerDown = 0x01;
constexpr unsigned kPllBy10 = 0x08;         // control 2
constexpr unsigned kLineMute = 0x20;        // receive gain
constexpr unsigned kSpeakersActive = 0x03;  // DAC volume: SLM, SRM

constexpr std::uint8_t kVolumeAtReset = 0x5C;      // 0 dB, muted
constexpr double kGainStep = 1.5, kGainZero = 23;  // dB, code of 0 dB
constexpr double kAttenuationStep = 6.0;
constexpr double kLineGainStep = 10.0;

constexpr unsigned kRead = 1u << 13, kOtherChip = 3u << 14;
constexpr int kWordBits = 16;
constexpr double kSoundFullScale = 32768.0;
constexpr double kPllTolerance = 0.02;

double from_db(double db) {
    return std::pow(10.0, db / 20.0);
}
/// Bits 6..2 of a volume register.
double volume(unsigned value) {
    return from_db(kGainStep * (static_cast<double>(value >> 2 & 31u) - kGainZero));
}

}  // namespace

void Si3000::reset() {
    registers_ = {};
    registers_[kAdcVolume] = registers_[kDacVolume] = kVolumeAtReset;
    secondary_ = false;
    period_ = primary_ = 0;
    speaker_ = 0.0;
}

void Si3000::set_released(bool released) {
    if (released == released_) return;
    released_ = released;
    reset();
}

/// Bit clocks a sample by the PLL against those between the frame syncs.
bool Si3000::in_step() const {
    if (period_ == 0) return false;
    const double divider = registers_[kControl2] & kPllBy10 ? 10.0 : 5.0;
    const double wanted = (registers_[kPllN] + 1.0) * divider * 1024.0 / (registers_[kPllM] + 1.0);
    return std::abs(static_cast<double>(period_) - wanted) <= kPllTolerance * wanted;
}

bool Si3000::sounding() const {
    return released_ && in_step() && (registers_[kControl1] & kSpeakerPower) &&
           !(registers_[kControl1] & kChipPowerDown) && (registers_[kDacVolume] & kSpeakersActive);
}

/// A secondary frame; what is read of the register.
std::uint8_t Si3000::command(std::uint16_t word) {
    const unsigned number = word >> 8 & 31u;
    if ((word & kOtherChip) || number < kControl1 || number >= kRegisters) return 0;
    if (word & kRead) return registers_[number];
    if (number == kStatus) return 0;
    if (number == kControl1 && (word & kSoftReset)) {
        reset();
        return 0;
    }
    registers_[number] = static_cast<std::uint8_t>(word & 0xFFu);
    return 0;
}

void Si3000::convert(std::uint16_t word) {
    if (!sounding()) {
        speaker_ = 0.0;
        return;
    }
    ++samples_;
    const auto sample = static_cast<std::int16_t>(word & 0xFFFEu);
    const double sides = (registers_[kDacVolume] & kSpeakersActive) == kSpeakersActive ? 1.0 : 0.5;
    const double attenuation = from_db(-kAttenuationStep * (registers_[kAttenuation] & 3u));
    speaker_ = std::clamp(sample / kSoundFullScale * volume(registers_[kDacVolume]), -1.0, 1.0) *
               attenuation * sides;
}

/// The line input as a sample.
std::uint16_t Si3000::listen(double line_in) const {
    if (!in_step() || (registers_[kControl1] & kChipPowerDown) || (registers_[kRxGain] & kLineMute)) return 0;
    const double preamplifier = from_db(kLineGainStep * std::min(registers_[kRxGain] >> 6, 2));
    const double value = line_in * preamplifier * volume(registers_[kAdcVolume]) * kSoundFullScale;
    const auto code =
        static_cast<std::int32_t>(std::lround(std::clamp(value, -kSoundFullScale, kSoundFullScale - 2.0)));
    return static_cast<std::uint16_t>(code) & 0xFFFEu;
}

std::uint16_t Si3000::exchange(const dspic::DciWord& word, double line_in) {
    if (!released_ || word.slot != 0 || word.bits != kWordBits) return 0;
    if (secondary_) {
        secondary_ = false;
        return command(word.value);
    }
    period_ = primary_ == 0 ? 0 : (word.frame - primary_) / word.bit_cycles;
    primary_ = word.frame;
    secondary_ = (word.value & 1u) != 0;
    convert(word.value);
    return listen(line_in);
}

}  // namespace puckloop::pic
