#include "emu/pic/emitter.h"

#include <cmath>

namespace puckloop::pic {

void Emitter::set(bool on, dspic::Cycle now) {
    if (on == on_) return;
    at_edge_ = intensity(now);
    edge_ = now;
    on_ = on;
}

double Emitter::intensity(dspic::Cycle now) const {
    const double target = on_ ? 1.0 : 0.0;
    const double age = now > edge_ ? static_cast<double>(now - edge_) : 0.0;
    // Less than 2e-35 is left, which moves no ADC code.
    constexpr double kSettled = 80.0;
    if (age > kSettled * time_constant_) return target;
    return target + (at_edge_ - target) * std::exp(-age / time_constant_);
}

}  // namespace puckloop::pic
