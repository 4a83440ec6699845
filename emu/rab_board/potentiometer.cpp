#include "emu/rab_board/potentiometer.h"

namespace puckloop::rab {

namespace {
constexpr int kBits = 8;
}

void Potentiometer::select(bool high, cosim::Time now) {
    if (high == high_) return;
    high_ = high;
    if (!high) {
        shifted_.reset();
    } else if (shifted_) {
        ++bytes_;
        latched_ = *shifted_;
        due_ = now + settling_;
    }
}

void Potentiometer::shift(std::uint16_t sent, int bits) {
    if (!high_ && bits >= kBits) shifted_ = static_cast<std::uint8_t>(sent);  // the last eight stay
}

std::uint8_t Potentiometer::settle() {
    due_ = cosim::kNever;
    return wiper_ = latched_;
}

}  // namespace puckloop::rab
