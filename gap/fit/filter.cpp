#include "gap/fit/filter.h"

#include "gap/fit/walk.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

using Lanes = Eigen::Array<double, static_cast<int>(kLanes), 1>;

constexpr double kClip = 5.0;        // innovations beyond do not pull the filter further
constexpr double kPileWidths = 3.0;  // from the ceiling: nearer readings were cut to it

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

/// Is the row at an end of what the instrument shows? Then its role and limit are noted.
bool clipped(const Observable& o, const Predicted& p, std::size_t i, double sd, Innovations& out) {
    const bool dead_zone = p.floor > 0.0;
    const bool low = o.y[i] <= (dead_zone && std::isnan(o.instrument.floor) ? 0.0 : o.instrument.floor);
    const bool high = o.y[i] >= o.instrument.ceiling;
    const bool piled = !low && !high && p.ceiling > 0.0 && o.y[i] >= p.ceiling - kPileWidths * p.pile;
    if (!low && !high && !piled) return false;
    const double floor = dead_zone ? p.floor : o.instrument.floor;
    out.role[i] = low ? RowRole::Low : high ? RowRole::High : RowRole::Piled;
    out.z[i] = ((low ? floor : high ? o.instrument.ceiling : p.ceiling) - p.mean[i]) / sd;
    return true;
}

void filter_level(const Observable& o, const Predicted& p, const NoiseParameters& noise, Innovations& out) {
    const double drift = std::exp(noise.carry), nu = std::exp(noise.log_tail);
    const RowSize size(o, p, noise);
    const bool pushes = !p.lapse.empty();
    if (pushes) out.mixed.assign(o.y.size(), 0.0);
    Walk walk{};
    PushedWalk pushed;
    bool carried = false;
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const double sd = size.at(i);
        if (o.starts[i] != 0) carried = false;
        if (clipped(o, p, i, sd, out)) {
            carried = false;
            continue;
        }
        const double error = (o.y[i] - p.mean[i]) / sd;
        if (!carried) {
            walk.begin(error);
            if (pushes) pushed.begin(error);
            out.role[i] = RowRole::First;
            out.z[i] = 0.0;
            carried = true;
            continue;
        }
        double innovation = 0.0;
        const double gained = at(o.walk, i, 0.0) + at(o.jolt, i, 0.0) / (sd * sd);
        const double variance = walk.filter(error, drift + gained, noise.memory, nu, innovation);
        out.z[i] = innovation / std::sqrt(variance);
        out.variance[i] = variance * sd * sd;
        if (!pushes) continue;
        const double width = p.lapse_scale[i] / sd;
        const auto row = pushed.filter(error, drift + gained, noise.memory, nu, p.lapse[i], width * width);
        out.z[i] = row.innovation;
        out.mixed[i] = row.cost + std::log(sd);
    }
}

void filter_carry(const Observable& o, const Predicted& p, const NoiseParameters& noise, Innovations& out) {
    const RowSize size(o, p, noise);
    const bool has_line = p.line_amplitude > 0.0 && !o.time.empty();
    const double omega = 2 * std::numbers::pi * p.line_frequency;
    Line line;
    bool carried = false;
    double last = 0.0;
    const double rest = 1 - noise.carry * noise.carry, root = std::sqrt(rest);
    std::array<double, 2> last_h{};
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const double sd = size.at(i);
        if (o.starts[i] != 0) {
            carried = false;
            line = Line{};
        }
        if (clipped(o, p, i, sd, out)) {
            carried = false;
            continue;
        }
        const double error = (o.y[i] - p.mean[i]) / sd;
        const double kept = carried ? noise.carry : 0.0;
        double innovation = error - kept * last, variance = carried ? rest : 1.0;
        last = error;
        if (!has_line) {
            out.z[i] = carried ? innovation / root : innovation;
            out.variance[i] = variance * sd * sd;
            carried = true;
            continue;
        }
        const double reach = p.line_amplitude * at(o.gate, i, 1.0) / sd;
        const std::array<double, 2> own{reach * std::cos(omega * o.time[i]),
                                        reach * std::sin(omega * o.time[i])};
        const std::array<double, 2> h{own[0] - kept * last_h[0], own[1] - kept * last_h[1]};
        last_h = own;
        line.filter(h, innovation, variance);
        carried = true;
        out.z[i] = innovation / std::sqrt(variance);
        out.variance[i] = variance * sd * sd;
    }
}

}  // namespace

bool is_plain_sum(const Observable& o, const Predicted& p) {
    return o.noise == NoiseKind::Level && p.factor.empty() && p.extra.empty() && p.lapse.empty() &&
           p.floor <= 0.0 && p.ceiling <= 0.0 && std::isnan(o.instrument.floor) &&
           std::isnan(o.instrument.ceiling);
}

void filter_sums(const Observable& o, const std::array<const Predicted*, kLanes>& predicted,
                 const std::array<NoiseParameters, kLanes>& noise,
                 const std::array<Innovations*, kLanes>& out) {
    const std::size_t n = o.y.size();
    std::array<const double*, kLanes> mean{};
    std::array<double*, kLanes> z{}, variance{};
    Lanes sd, memory, drift, tail;
    for (std::size_t k = 0; k < kLanes; ++k) {
        const auto lane = static_cast<Eigen::Index>(k);
        mean[k] = predicted[k]->mean.data();
        sd[lane] = RowSize(o, *predicted[k], noise[k]).at(0);
        memory[lane] = noise[k].memory;
        drift[lane] = std::exp(noise[k].carry);
        tail[lane] = std::exp(noise[k].log_tail);
        out[k]->z.resize(n);
        out[k]->variance.assign(n, 1.0);
        out[k]->role.assign(n, RowRole::Plain);
        out[k]->mixed.clear();
        z[k] = out[k]->z.data();
        variance[k] = out[k]->variance.data();
    }
    const Lanes squared_sd = sd * sd;
    WalkOf<Lanes> walk;
    for (std::size_t i = 0; i < n; ++i) {
        Lanes error, innovation;
        for (std::size_t k = 0; k < kLanes; ++k)
            error[static_cast<Eigen::Index>(k)] = o.y[i] - mean[k][i];
        error /= sd;
        if (i == 0 || o.starts[i] != 0) {
            walk.begin(error);
            for (std::size_t k = 0; k < kLanes; ++k) {
                out[k]->role[i] = RowRole::First;
                z[k][i] = 0.0;
            }
            continue;
        }
        const Lanes gained = at(o.walk, i, 0.0) + at(o.jolt, i, 0.0) / squared_sd;
        const Lanes total = walk.filter(error, drift + gained, memory, tail, innovation);
        const Lanes standard = innovation / total.sqrt(), own = total * sd * sd;
        for (std::size_t k = 0; k < kLanes; ++k) {
            z[k][i] = standard[static_cast<Eigen::Index>(k)];
            variance[k][i] = own[static_cast<Eigen::Index>(k)];
        }
    }
}

void filter(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
            Innovations& out) {
    const std::size_t n = observable.y.size();
    out.z.resize(n);
    out.variance.assign(n, 1.0);
    out.role.assign(n, RowRole::Plain);
    out.mixed.clear();
    if (observable.noise == NoiseKind::Event) {
        out.role.assign(n, RowRole::Event);
        for (std::size_t i = 0; i < n; ++i)
            out.z[i] = std::clamp(predicted.mean[i], kLeastProbability, 1 - kLeastProbability);
    } else if (observable.noise == NoiseKind::Level) {
        filter_level(observable, predicted, noise, out);
    } else {
        filter_carry(observable, predicted, noise, out);
    }
}

}  // namespace puckloop::gap
