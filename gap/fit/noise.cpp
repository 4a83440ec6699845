#include "gap/fit/noise.h"

#include "gap/evidence/thresholds.h"
#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kLeastSd = 1e-12, kLeastVariance = 1e-6;  // of a reading; of an event
constexpr double kLeastTail = 0.5;    // degrees of freedom above 2: nearer, a sd says nothing of the scale
constexpr double kFixedDrift = -9.0;  // of noise that is not fitted
constexpr double kFixedTail = 4.0;

}  // namespace

double& noise_parameter(NoiseParameters& noise, int index) {
    return index == 0 ? noise.log_sd : index == 1 ? noise.carry : index == 2 ? noise.log_tail : noise.memory;
}

int noise_parameters(const Observable& observable) {
    if (observable.fixed_sd > 0) return 0;
    return observable.noise == NoiseKind::Event ? 0 : observable.noise == NoiseKind::Level ? 4 : 3;
}

std::pair<double, double> noise_bounds(NoiseKind kind, int index) {
    const std::pair<double, double> bounds[] = {{-30.0, 15.0},
                                                kind == NoiseKind::Level ? std::pair(-16.0, 6.0)
                                                                         : std::pair(-0.5, 0.97),
                                                {std::log(2.2), std::log(60.0)},
                                                {0.0, 0.95}};
    return bounds[index];
}

RowSize::RowSize(const Observable& o, const Predicted& p, const NoiseParameters& noise)
    : predicted_(p),
      own_(std::exp(noise.log_sd)),
      rounding_(o.instrument.quantum * o.instrument.quantum / 12),
      even_(p.factor.empty() && p.extra.empty()) {
    const double nu = std::exp(noise.log_tail);
    tail_ = std::max(nu - 2, kLeastTail) / nu;
    if (even_) sd_ = of(0);
}

double RowSize::of(std::size_t i) const {
    const double sd = own_ * of_row(predicted_.factor, i, 1.0), extra = of_row(predicted_.extra, i, 0.0);
    return std::max(std::sqrt(sd * sd + tail_ * extra * extra + rounding_), kLeastSd);
}

double row_sd(const Observable& o, const Predicted& p, const NoiseParameters& noise, std::size_t i) {
    if (o.noise != NoiseKind::Event) return RowSize(o, p, noise).at(i);
    return std::sqrt(std::max(p.mean[i] * (1 - p.mean[i]), kLeastVariance));
}

bool is_within_step(const Observable& o, const NoiseParameters& noise) {
    const double step = o.instrument.quantum;
    return o.noise == NoiseKind::Carry &&
           std::hypot(std::exp(noise.log_sd), step / std::sqrt(12.0)) < step / 2;
}

bool is_rounding(const Observable& o, const NoiseParameters& noise) {
    return o.noise == NoiseKind::Level &&
           std::exp(noise.log_sd) < thresholds::kFineNoise * o.instrument.quantum;
}

NoiseParameters first_guess(const Observable& o, const Predicted& p) {
    NoiseParameters guess;
    if (o.noise == NoiseKind::Event) return guess;
    const bool level = o.noise == NoiseKind::Level;
    if (o.fixed_sd > 0) return {std::log(o.fixed_sd), kFixedDrift, std::log(kFixedTail), 0.0};
    std::vector<double> sizes;
    double last = 0.0, product = 0.0, square = 0.0;
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const double error = o.y[i] - p.mean[i];
        const bool clipped = o.instrument.at_end(o.y[i]);
        if (o.starts[i] == 0) {
            product += error * last;
            square += error * error;
            if (level) sizes.push_back(std::abs(error - last) / std::numbers::sqrt2);
        }
        if (!level && !clipped) sizes.push_back(std::abs(error));
        last = error;
    }
    double sd = 1.0;
    if (!sizes.empty()) {
        const double middle = stats::upper_median(sizes), mean = stats::mean(sizes);
        sd = std::max({stats::kMadToSigma * middle, 0.3 * mean, o.instrument.quantum / 4, 1e-9});
    }
    guess.log_sd = std::log(sd);
    guess.log_tail = std::log(8.0);
    guess.memory = level ? 0.3 : 0.0;
    guess.carry = level ? -7.0 : std::clamp(square > 0 ? product / square : 0.0, 0.0, 0.9);
    return guess;
}

}  // namespace puckloop::gap
