#include "linuxboard/control/rab/rab_range.h"

#include <algorithm>
#include <cmath>

namespace puckloop::control {

namespace {

constexpr double kA = 9.06422181283387;
constexpr double kB = -0.00565074879677167;  // per unit of strength
constexpr double kCalibrationDistance = 20;  // cm

}  // namespace

double range_cm(double strength, double gain) {
    return gain * std::exp(kA + kB * strength);
}

bool RangeCalibration::add(int id, double bearing, double strength) {
    if (complete() || id == 0 || id == own_id_ || bearing == 0) return false;
    ++count_;
    sum_ += strength;
    squares_ += strength * strength;
    return true;
}

double RangeCalibration::deviation() const {
    if (count_ < 2) return 0;
    const double n = count_;
    return std::sqrt(std::max(0.0, (squares_ - sum_ * sum_ / n) / (n - 1)));
}

std::optional<double> RangeCalibration::gain() const {
    if (!complete() || count_ == 0) return std::nullopt;
    return kCalibrationDistance / range_cm(mean_strength(), 1);
}

}  // namespace puckloop::control
