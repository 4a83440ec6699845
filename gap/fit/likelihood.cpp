#include "gap/fit/likelihood.h"

#include "gap/stats/tails.h"

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastTailDensity = 1e-15;
constexpr double kSmall = 1e-4;  // below, the series of ln(1 + q) is exact to rounding

double square(double value) {
    return value * value;
}

/// ln(1 + q), q >= 0; std::log1p takes twice as long.
double log_above(double q) {
    return q < kSmall ? q * (1 - q * (0.5 - q / 3)) : std::log(1 + q);
}

double clip_likelihood(RowRole role, double z) {
    return kLeastProbability + (1 - kLeastProbability) * stats::normal_tail(role == RowRole::Low ? -z : z);
}

/// The row's reading was cut off: all that is known is which side of an end it lies on.
bool is_cut(RowRole role) {
    return role == RowRole::Low || role == RowRole::High || role == RowRole::Piled;
}

double event_cost(double y, double mean) {
    return -std::log(y > 0.5 ? mean : 1 - mean);
}

/// A row that is a lapse with some probability; `tail` is twice the deviance of t.
double lapse_cost(const Predicted& p, std::size_t i, double z, double sd, double tail, double constant) {
    const double lapse = p.lapse[i];
    const double width = p.lapse_scale[i] / sd, shift = of_row(p.lapse_shift, i) / sd;
    const double wide = lapse * std::exp(-0.5 * std::log(2 * kPi) - constant) / std::sqrt(width * width + 1);
    const double peak = 1 - lapse + wide;
    const double spread = 2 * (width * width + 1);
    const double up = std::exp(-square(z - shift) / spread);
    const double hit = p.lapse_both ? (up + std::exp(-square(z + shift) / spread)) / 2 : up;
    const double here = (1 - lapse) * std::exp(-tail / 2) + wide * hit;
    return std::max(std::log(peak / here), 0.0) + std::max(-std::log(peak), 0.0);
}

/// Innovation of a row that may be a lapse, as far out in the noise's own law as it is in the mixture's (a
/// quantile residual: Dunn and Smyth, J. Comput. Graph. Stat. 5, 1996).
double quantile_residual(const Predicted& p, std::size_t i, double z, double sd,
                         const stats::StudentLaw& law) {
    const double lapse = p.lapse[i], shift = of_row(p.lapse_shift, i) / sd;
    const double spread = std::hypot(p.lapse_scale[i] / sd, 1.0), side = z < 0 ? -1.0 : 1.0;
    const double here = stats::normal_tail((side * z - side * shift) / spread),
                 other = p.lapse_both ? stats::normal_tail((side * z + side * shift) / spread) : here;
    const double beyond = (1 - lapse) * law.tail(side * z) + lapse * (here + other) / 2;
    return side * law.beyond(std::clamp(beyond, kLeastTailDensity, 1 - kLeastTailDensity));
}

/// Readings inside a dead zone should not be there.
double dead_zone_cost(const Observable& o, double floor, double y) {
    const double step = std::max(o.instrument.quantum, 1e-3 * floor);
    const double inside = (floor - y) / step;
    return inside > 30 ? inside : std::log1p(std::exp(inside));
}

/// Readings cut to the ceiling lie within the pile's width of it; beyond they should not be. The density is a
/// normal one near the ceiling and falls exponentially further off.
double pile_cost(const Predicted& p, double y, RowRole role) {
    if (p.ceiling <= 0.0 || role == RowRole::Low) return 0.0;
    constexpr double kStraight = 3.0;  // widths
    const double off = std::abs(y - p.ceiling) / p.pile;
    const double beside = off < kStraight ? off * off / 2 : kStraight * (off - kStraight / 2);
    return role == RowRole::High ? beside : beside + std::log(p.pile) + 0.5 * std::log(2 * kPi);
}

/// ln of a product of many factors, each at least 1 or near it, taken whenever it grows large.
class LogProduct {
  public:
    void add(double factor) {
        product_ *= factor;
        if (product_ < kLarge && product_ > 1 / kLarge) return;
        sum_ += std::log(product_ / factor) + std::log(factor);
        product_ = 1.0;
    }
    double value() const { return sum_ + std::log(product_); }

  private:
    static constexpr double kLarge = 1e100;
    double product_ = 1.0, sum_ = 0.0;
};

}  // namespace

bool is_simple(const Predicted& predicted) {
    return predicted.lapse.empty() && predicted.chance.empty() && predicted.floor <= 0.0 &&
           predicted.ceiling <= 0.0;
}

void costs_of(const Observable& o, const Predicted& p, const NoiseParameters& noise,
              const Innovations& innovations, std::vector<double>& cost) {
    const std::size_t n = o.y.size();
    cost.resize(n);
    const double nu = std::exp(noise.log_tail), constant = stats::StudentLaw(nu).log_height();
    double variance = 1.0, log_scale = 0.0;  // mostly the same as the row before's
    for (std::size_t i = 0; i < n; ++i) {
        const double z = innovations.z[i];
        const RowRole role = innovations.role[i];
        if (role != RowRole::Plain) {
            cost[i] = role == RowRole::First ? 0.0
                      : role == RowRole::Event
                          ? event_cost(o.y[i], z)
                          : -std::log(clip_likelihood(role, z)) + pile_cost(p, o.y[i], role);
            continue;
        }
        if (!innovations.mixed.empty()) {
            cost[i] = innovations.mixed[i] - constant;
            continue;
        }
        if (innovations.variance[i] != variance) {
            variance = innovations.variance[i];
            log_scale = 0.5 * std::log(variance);
        }
        const double tail = (nu + 1) * log_above(z * z / nu);
        const bool lapses = !p.lapse.empty() && p.lapse[i] > 0.0;
        cost[i] = log_scale - constant +
                  (lapses ? lapse_cost(p, i, z, std::sqrt(variance), tail, constant) : tail / 2);
        if (p.floor > 0.0) cost[i] += dead_zone_cost(o, p.floor, o.y[i]);
        if (!p.chance.empty()) cost[i] -= std::log(p.chance[i]);
    }
}

double cost_sum(const Observable& o, const Predicted& p, const NoiseParameters& noise,
                const Innovations& innovations, const std::vector<double>& weights) {
    const std::size_t n = o.y.size();
    const bool plain =
        is_simple(p) && innovations.mixed.empty() && std::ranges::all_of(innovations.role, [](RowRole role) {
            return role == RowRole::Plain || role == RowRole::First;
        });
    if (!plain) {
        std::vector<double> cost;
        costs_of(o, p, noise, innovations, cost);
        double sum = 0.0;
        for (std::size_t i = 0; i < n; ++i)
            sum += weights.empty() ? cost[i] : weights[i] * cost[i];
        return sum;
    }
    const double nu = std::exp(noise.log_tail), constant = stats::StudentLaw(nu).log_height();
    LogProduct tails, scales;
    double rows = 0.0, others = 0.0, unit = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double weight = weights.empty() ? 1.0 : weights[i];
        if (innovations.role[i] == RowRole::First || weight == 0.0) continue;
        const double z = innovations.z[i], tail = 1 + z * z / nu, variance = innovations.variance[i];
        if (weight != 1.0) {
            others += weight * ((nu + 1) / 2 * std::log(tail) + std::log(variance) / 2 - constant);
            continue;
        }
        if (unit == 0.0) unit = variance;
        tails.add(tail);
        if (variance != unit) scales.add(variance / unit);
        rows += 1;
    }
    if (rows == 0.0) return others;
    return others + (nu + 1) / 2 * tails.value() + scales.value() / 2 +
           rows * (std::log(unit) / 2 - constant);
}

void row_costs(const Observable& o, const Predicted& p, const NoiseParameters& noise, RowCosts& out) {
    Innovations innovations;
    filter(o, p, noise, innovations);
    costs_of(o, p, noise, innovations, out.cost);
    out.innovation = std::move(innovations.z);
    const stats::StudentLaw law(std::exp(noise.log_tail));
    for (std::size_t i = 0; i < out.innovation.size(); ++i) {
        double& z = out.innovation[i];
        const RowRole role = innovations.role[i];
        if (role == RowRole::Event)
            z = ((o.y[i] > 0.5 ? 1.0 : 0.0) - z) / std::sqrt(z * (1 - z));
        else if (is_cut(role))
            z = (role == RowRole::Low ? 1 : -1) * stats::normal_quantile(clip_likelihood(role, z) / 2);
        else if (role == RowRole::Plain && innovations.mixed.empty() && of_row(p.lapse, i) > 0.0)
            z = quantile_residual(p, i, z, std::sqrt(innovations.variance[i]), law);
    }
}

void slopes_of(const Observable& o, const NoiseParameters& noise, const Innovations& innovations,
               RowSlopes& out) {
    const std::size_t n = o.y.size();
    out.slope.assign(n, 0.0);
    out.curvature.assign(n, 0.0);
    out.tail.assign(n, 0.0);
    const double nu = std::exp(noise.log_tail), expected = (nu + 1) / (nu + 3);
    const double constant = (boost::math::digamma((nu + 1) / 2) - boost::math::digamma(nu / 2) - 1 / nu) / 2;
    for (std::size_t i = 0; i < n; ++i) {
        const double z = innovations.z[i], q = z * z / nu;
        const RowRole role = innovations.role[i];
        if (role == RowRole::Plain) {
            out.slope[i] = (nu + 1) * z / (nu + z * z);
            out.curvature[i] = expected;
            out.tail[i] = nu * (log_above(q) / 2 - (nu + 1) / (2 * nu) * q / (1 + q) - constant);
        } else if (role == RowRole::Event) {
            out.slope[i] = o.y[i] > 0.5 ? -1 / z : 1 / (1 - z);
            out.curvature[i] = 1 / (z * (1 - z));
        } else if (is_cut(role)) {
            const double sign = role == RowRole::Low ? 1 : -1;
            const double hazard =
                (1 - kLeastProbability) * stats::normal_density(z) / clip_likelihood(role, z);
            const double bend = hazard * (hazard + sign * z);
            out.slope[i] = -sign * hazard;
            out.curvature[i] = bend > 0 ? bend : hazard * hazard;
        }
    }
}

ScaleInformation scale_information(const NoiseParameters& noise) {
    const double nu = std::exp(noise.log_tail);
    ScaleInformation information;
    information.scale = 2 * nu / (nu + 3);
    information.both = -2 * nu / ((nu + 1) * (nu + 3));
    information.tail = nu * nu *
                       ((boost::math::trigamma(nu / 2) - boost::math::trigamma((nu + 1) / 2)) / 4 -
                        (nu + 5) / (2 * nu * (nu + 1) * (nu + 3)));
    return information;
}

}  // namespace puckloop::gap
