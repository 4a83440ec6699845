#include "emu/pic/stepper.h"

namespace puckloop::pic {

namespace {

constexpr std::uint8_t kCoilsOff = 0;
constexpr int kPhases = 4;
constexpr int kNotAPhase = -1;

/// Phase table of the e-puck library, coils D C B A.
constexpr int phase_of(std::uint8_t pattern) {
    switch (pattern) {
    case 0b1010:
        return 0;
    case 0b0110:
        return 1;
    case 0b0101:
        return 2;
    case 0b1001:
        return 3;
    default:
        return kNotAPhase;
    }
}

}  // namespace

void StepperDecoder::coils(std::uint8_t pattern, dspic::Cycle now) {
    if (pattern == pattern_) return;
    settle(now);
    pattern_ = pattern;
    const bool idle = pattern == kCoilsOff || phase_of(pattern) == phase_;
    due_ = idle ? dspic::kNoCycle : now + settle_;
}

bool StepperDecoder::settle(dspic::Cycle now) {
    if (due_ > now) return false;
    due_ = dspic::kNoCycle;
    const int phase = phase_of(pattern_);
    if (phase == kNotAPhase) {
        ++illegal_;
        return false;
    }
    const int distance = (phase - phase_ + kPhases) % kPhases;
    phase_ = static_cast<std::uint8_t>(phase);
    if (distance == 2) {
        ++jumps_;
        return false;
    }
    if (held_) {
        ++lost_;
        return false;
    }
    const int along = distance == 1 ? 1 : -1;
    steps_ += along * static_cast<int>(sense_);
    return true;
}

}  // namespace puckloop::pic
