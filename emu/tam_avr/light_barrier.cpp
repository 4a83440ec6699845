#include "emu/tam_avr/light_barrier.h"

#include "emu/tam_avr/pin_table.h"

#include <algorithm>
#include <cmath>

namespace puckloop::tam {

double LightBarrier::beam(cosim::Time now) const {
    const double elapsed = static_cast<double>(now - edge_) / static_cast<double>(parameters_.time_constant);
    return settled() + (at_edge_ - settled()) * std::exp(-std::max(elapsed, 0.0));
}

void LightBarrier::set_interrupted(double part, cosim::Time now) {
    at_edge_ = beam(now);
    edge_ = now;
    interrupted_ = part;
}

void LightBarrier::set_duty(double duty, cosim::Time now) {
    at_edge_ = beam(now);
    edge_ = now;
    duty_ = duty;
}

double LightBarrier::volts(cosim::Time now) const {
    return std::clamp(ambient_ + glare_ * kSupplyVolts + beam(now), 0.0, kSupplyVolts);
}

}  // namespace puckloop::tam
