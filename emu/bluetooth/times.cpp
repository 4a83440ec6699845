#include "emu/bluetooth/times.h"

#include <algorithm>
#include <cmath>

namespace puckloop::bluetooth {

namespace {

constexpr double kLongest = 3600.0;  // s: a drawn time stays a time

cosim::Time to_time(double seconds) {
    return std::max(kShortest, cosim::from_seconds(std::clamp(seconds, 0.0, kLongest)));
}

/// Gamma with shape >= 1 and scale 1 (Marsaglia and Tsang 2000).
double gamma(double shape, RandomStream& random) {
    const double d = shape - 1.0 / 3.0, c = 1.0 / std::sqrt(9.0 * d);
    for (;;) {
        const double x = random.normal();
        const double v = std::pow(1.0 + c * x, 3.0);
        const double u = 1.0 - random.uniform();
        if (v > 0 && std::log(u) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
    }
}

}  // namespace

cosim::Time draw_exponential(double mean, RandomStream& random) {
    return to_time(-mean * std::log(1.0 - random.uniform()));
}

cosim::Time draw(const Spread& spread, RandomStream& random) {
    if (!(spread.sd > 0)) return to_time(spread.mean);
    const double shape = (spread.mean / spread.sd) * (spread.mean / spread.sd);
    // Below 1 by Gamma(a) = Gamma(a + 1) U^(1/a).
    double value = gamma(shape < 1 ? shape + 1 : shape, random);
    if (shape < 1) value *= std::pow(1.0 - random.uniform(), 1.0 / shape);
    return to_time(value * spread.mean / shape);
}

}  // namespace puckloop::bluetooth
