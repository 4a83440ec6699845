#include "gap/fit/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastProbability = 1e-3;  // a model is never surer than this of a single event or clip
constexpr double kClip = 5.0;               // innovations beyond do not pull the filter further
constexpr double kLeastSd = 1e-12;
constexpr double kFixedDrift = -9.0;  // of noise that is not fitted
constexpr double kFixedTail = 4.0;

double t_constant(double nu) {
    return std::lgamma((nu + 1) / 2) - std::lgamma(nu / 2) - 0.5 * std::log(nu * kPi);
}

double normal_below(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Inverse of the normal distribution, good to 1e-4: enough for a picture of a clipped row.
double normal_quantile(double p) {
    const bool low = p < 0.5;
    const double t = std::sqrt(-2 * std::log(std::max(low ? p : 1 - p, 1e-300)));
    const double z =
        t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    return low ? -z : z;
}

double square(double value) {
    return value * value;
}

double at(const std::vector<double>& values, std::size_t i, double neutral) {
    return values.empty() ? neutral : values[i];
}

/// Sinusoid of unknown phase: two amplitudes learnt row by row.
struct Line {
    std::array<double, 2> mean{};
    double p00 = 0.5, p01 = 0.0, p11 = 0.5;

    /// Takes what is known off the innovation, widens its variance, learns from it.
    void filter(const std::array<double, 2>& h, double& innovation, double& variance) {
        innovation -= h[0] * mean[0] + h[1] * mean[1];
        const double g0 = p00 * h[0] + p01 * h[1], g1 = p01 * h[0] + p11 * h[1];
        variance += h[0] * g0 + h[1] * g1;
        const double root = std::sqrt(variance);
        const double pull = std::clamp(innovation / root, -kClip, kClip) / root;
        mean[0] += g0 * pull;
        mean[1] += g1 * pull;
        p00 -= g0 * g0 / variance;
        p01 -= g0 * g1 / variance;
        p11 -= g1 * g1 / variance;
    }
};

/// Random walk plus carried-over measurement error; variances in units of the error's.
struct Walk {
    double level = 0.0, error = 0.0;
    double p00 = 1.0, p01 = -1.0, p11 = 1.0;

    /// The first row: level and error are known only together.
    void begin(double value) { *this = {value, 0.0, 1.0, -1.0, 1.0}; }

    /// Returns the innovation's variance.
    double filter(double value, double drift, double memory, double tail, bool jumps, double& innovation) {
        p00 += drift;
        p01 *= memory;
        p11 = memory * memory * p11 + 1 - memory * memory;
        error *= memory;
        innovation = value - level - error;
        const double total = std::max(p00 + 2 * p01 + p11, 1e-9);
        const double squared = innovation * innovation / total;
        if (jumps && squared > kClip * kClip) {  // pushed: the sum goes on from there
            begin(value);
            return total;
        }
        // An outlier of a heavy tail says little about the sum; smooth, so that the likelihood is.
        const double trust = std::min((tail + 1) / (tail + squared), 1.0);
        const double k0 = (p00 + p01) / total, k1 = (p01 + p11) / total;
        level += k0 * trust * innovation;
        error += k1 * trust * innovation;
        const double g0 = p00 + p01, g1 = p01 + p11;
        p00 -= k0 * g0;
        p01 -= k0 * g1;
        p11 -= k1 * g1;
        return total;
    }
};

void event_costs(const Observable& o, const Predicted& p, RowCosts& out) {
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const double mean = std::clamp(p.mean[i], kLeastProbability, 1 - kLeastProbability);
        const bool yes = o.y[i] > 0.5;
        const double likely = yes ? mean : 1 - mean;
        out.shape[i] = (yes ? 1 : -1) * std::sqrt(-2 * std::log(likely));
        out.level[i] = 0.0;
        out.innovation[i] = ((yes ? 1.0 : 0.0) - mean) / std::sqrt(mean * (1 - mean));
    }
}

}  // namespace

double& noise_parameter(NoiseParameters& noise, int index) {
    return index == 0 ? noise.log_sd : index == 1 ? noise.carry : index == 2 ? noise.log_tail : noise.memory;
}

int noise_parameters(const Observable& observable) {
    if (observable.fixed_sd > 0) return 0;
    return observable.noise == NoiseKind::Event ? 0 : observable.noise == NoiseKind::Level ? 4 : 3;
}

void noise_bounds(NoiseKind kind, int index, double& low, double& high) {
    if (index == 0) {
        low = -30;
        high = 15;
    } else if (index == 1) {
        low = kind == NoiseKind::Level ? -16.0 : -0.5;
        high = kind == NoiseKind::Level ? 6.0 : 0.97;
    } else if (index == 2) {
        low = std::log(2.2);
        high = std::log(60.0);
    } else {
        low = 0.0;
        high = 0.95;
    }
}

double row_sd(const Observable& o, const Predicted& p, const NoiseParameters& noise, std::size_t i) {
    const double sd = std::exp(noise.log_sd) * at(p.factor, i, 1.0);
    const double extra = at(p.extra, i, 0.0);
    const double quantum = o.instrument.quantum;
    return std::max(std::sqrt(sd * sd + extra * extra + quantum * quantum / 12), kLeastSd);
}

void row_costs(const Observable& o, const Predicted& p, const NoiseParameters& noise, RowCosts& out) {
    const std::size_t n = o.y.size();
    out.shape.resize(n);
    out.level.resize(n);
    out.innovation.resize(n);
    out.other.clear();
    if (o.noise == NoiseKind::Event) return event_costs(o, p, out);
    const bool dead_zone = p.floor > 0.0;
    if (dead_zone || !p.lapse.empty()) out.other.assign(n, 0.0);
    const double nu = std::exp(noise.log_tail);
    const double constant = t_constant(nu);
    const double drift = std::exp(noise.carry);
    const bool has_line = p.line_amplitude > 0.0 && !o.time.empty();
    const double omega = 2 * kPi * p.line_frequency;
    Line line;
    Walk walk;
    bool carried = false;
    double last = 0.0;
    std::array<double, 2> last_h{};
    const double fixed_sd = row_sd(o, {p.mean, {}, {}, {}, {}}, noise, 0), fixed_log = std::log(fixed_sd);
    const bool one_sd = p.factor.empty() && p.extra.empty();
    for (std::size_t i = 0; i < n; ++i) {
        const double sd = one_sd ? fixed_sd : row_sd(o, p, noise, i);
        const double log_sd = one_sd ? fixed_log : std::log(sd);
        if (o.starts[i] != 0) {
            carried = false;
            line = Line{};
            walk = Walk{};
        }
        const bool low = o.y[i] <= o.instrument.floor, high = o.y[i] >= o.instrument.ceiling;
        if (low || high) {
            const double limit = low ? (dead_zone ? p.floor : o.instrument.floor) : o.instrument.ceiling;
            const double z = (limit - p.mean[i]) / sd;
            const double likely = kLeastProbability + (1 - kLeastProbability) * normal_below(low ? z : -z);
            out.shape[i] = (low ? -1 : 1) * std::sqrt(-2 * std::log(likely));
            out.level[i] = 0.0;
            out.innovation[i] = (low ? 1 : -1) * normal_quantile(likely / 2);
            carried = false;
            continue;
        }
        const double error = (o.y[i] - p.mean[i]) / sd;
        double innovation = error, variance = 1.0;
        if (o.noise == NoiseKind::Level) {
            if (!carried) {  // the first row only says where the sum begins
                walk.begin(error);
                out.shape[i] = out.level[i] = out.innovation[i] = 0.0;
                carried = true;
                continue;
            }
            const double gained = at(o.walk, i, 0.0) + at(o.jolt, i, 0.0) / (sd * sd);
            variance = walk.filter(error, drift + gained, noise.memory, nu, !p.lapse.empty(), innovation);
        } else {
            const double kept = carried ? noise.carry : 0.0;
            innovation = error - kept * last;
            variance = 1 - kept * kept;
            last = error;
            if (has_line) {
                const double size = p.line_amplitude * at(o.gate, i, 1.0) / sd;
                const std::array<double, 2> own{size * std::cos(omega * o.time[i]),
                                                size * std::sin(omega * o.time[i])};
                const std::array<double, 2> h{own[0] - kept * last_h[0], own[1] - kept * last_h[1]};
                last_h = own;
                line.filter(h, innovation, variance);
            }
        }
        carried = true;
        const double root = std::sqrt(variance);
        const double z = innovation / root;
        out.innovation[i] = z;
        out.level[i] = log_sd + std::log(root) - constant;
        const double tail = (nu + 1) * std::log1p(z * z / nu);  // twice the deviance of t
        const double lapse = at(p.lapse, i, 0.0);
        if (lapse <= 0.0) {
            out.shape[i] = std::copysign(std::sqrt(tail), z);
        } else {
            const double width = p.lapse_scale[i] / (sd * root), shift = p.lapse_shift / (sd * root);
            const double wide =
                lapse * std::exp(-0.5 * std::log(2 * kPi) - constant) / std::sqrt(width * width + 1);
            const double peak = 1 - lapse + wide;
            const double spread = 2 * (width * width + 1);
            const double up = std::exp(-square(z - shift) / spread);
            const double hit = p.lapse_both ? (up + std::exp(-square(z + shift) / spread)) / 2 : up;
            const double here = (1 - lapse) * std::exp(-tail / 2) + wide * hit;
            out.shape[i] = std::copysign(std::sqrt(2 * std::max(std::log(peak / here), 0.0)), z);
            out.other[i] += std::max(-std::log(peak), 0.0);
        }
        if (dead_zone) {  // readings inside the dead zone should not be there
            const double step = std::max(o.instrument.quantum, 1e-3 * p.floor);
            const double inside = (p.floor - o.y[i]) / step;
            out.other[i] += inside > 30 ? inside : std::log1p(std::exp(inside));
        }
    }
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
        const bool clipped = o.y[i] <= o.instrument.floor || o.y[i] >= o.instrument.ceiling;
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
        const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
        std::nth_element(sizes.begin(), middle, sizes.end());
        double mean = 0.0;
        for (const double size : sizes)
            mean += size / static_cast<double>(sizes.size());
        sd = std::max({1.4826 * *middle, 0.3 * mean, o.instrument.quantum / 4, 1e-9});
    }
    guess.log_sd = std::log(sd);
    guess.log_tail = std::log(8.0);
    guess.memory = level ? 0.3 : 0.0;
    guess.carry = level ? -7.0 : std::clamp(square > 0 ? product / square : 0.0, 0.0, 0.9);
    return guess;
}

}  // namespace puckloop::gap
