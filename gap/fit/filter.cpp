#include "gap/fit/filter.h"

#include "gap/fit/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

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

/// The noise's size row by row; the same in all rows unless the prediction says otherwise.
class Size {
  public:
    Size(const Observable& o, const Predicted& p, const NoiseParameters& noise)
        : o_(o),
          p_(p),
          noise_(noise),
          even_(p.factor.empty() && p.extra.empty()),
          sd_(o.y.empty() ? 1.0 : row_sd(o, p, noise, 0)) {}
    double at(std::size_t i) const { return even_ ? sd_ : row_sd(o_, p_, noise_, i); }

  private:
    const Observable& o_;
    const Predicted& p_;
    const NoiseParameters& noise_;
    bool even_;
    double sd_;
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
    const Size size(o, p, noise);
    const bool pushes = !p.lapse.empty();
    if (pushes) out.mixed.assign(o.y.size(), 0.0);
    Walk walk;
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
    const Size size(o, p, noise);
    const bool has_line = p.line_amplitude > 0.0 && !o.time.empty();
    const double omega = 2 * std::numbers::pi * p.line_frequency;
    Line line;
    bool carried = false;
    double last = 0.0;
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
        double innovation = error - kept * last, variance = 1 - kept * kept;
        last = error;
        if (has_line) {
            const double reach = p.line_amplitude * at(o.gate, i, 1.0) / sd;
            const std::array<double, 2> own{reach * std::cos(omega * o.time[i]),
                                            reach * std::sin(omega * o.time[i])};
            const std::array<double, 2> h{own[0] - kept * last_h[0], own[1] - kept * last_h[1]};
            last_h = own;
            line.filter(h, innovation, variance);
        }
        carried = true;
        out.z[i] = innovation / std::sqrt(variance);
        out.variance[i] = variance * sd * sd;
    }
}

}  // namespace

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
