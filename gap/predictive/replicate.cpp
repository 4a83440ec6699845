#include "gap/predictive/replicate.h"

#include "gap/fit/filter.h"
#include "gap/fit/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kOnStep = 0.02;  // of a step: as near to a multiple as clean/quantum.cpp asks
constexpr double kLeastScale = 1e-12;

/// Student's t by Bailey's polar method (Math. Comput. 62, 1994): exact for any degrees of freedom.
double student(double degrees, RandomStream& random) {
    const double radius = std::sqrt(degrees * (std::pow(1 - random.uniform(), -2 / degrees) - 1));
    return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

/// Do the values keep to the instrument's step, counted from the first of them?
bool keeps_to_step(const Observable& o) {
    const double step = o.instrument.quantum;
    return step > 0 && std::all_of(o.y.begin(), o.y.end(), [&](double value) {
               return std::abs(std::remainder(value - o.y.front(), step)) < kOnStep * step;
           });
}

/// What a lapse adds; 0 in most rows.
double lapse_of(const Predicted& p, std::size_t i, RandomStream& random) {
    if (p.lapse.empty() || random.uniform() >= p.lapse[i]) return 0.0;
    const double side = p.lapse_both && random.uniform() < 0.5 ? -1.0 : 1.0;
    return side * of_row(p.lapse_shift, i) + p.lapse_scale[i] * random.normal();
}

/// First-order autoregression of t innovations, beside a line of unknown phase.
void add_carried(const Observable& o, const Predicted& p, const NoiseParameters& noise,
                 const std::vector<double>& scale, RandomStream& random, std::vector<double>& y) {
    const double nu = std::exp(noise.log_tail);
    const double omega = 2 * std::numbers::pi * p.line_frequency;
    const bool has_line = p.line_amplitude > 0.0 && !o.time.empty();
    double error = 0.0, sine = 0.0, cosine = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const bool starts = i == 0 || o.starts[i] != 0;
        if (starts && has_line) {
            cosine = random.normal() / std::numbers::sqrt2;
            sine = random.normal() / std::numbers::sqrt2;
        }
        const double sd = scale[i], news = student(nu, random);
        const double kept = starts ? 0.0 : std::pow(noise.carry, o.steps.empty() ? 1 : o.steps[i]);
        error = kept * error + std::sqrt(1 - kept * kept) * news;
        y[i] += sd * error + lapse_of(p, i, random);
        if (has_line)
            y[i] += p.line_amplitude * of_row(o.gate, i, 1.0) *
                    (cosine * std::cos(omega * o.time[i]) + sine * std::sin(omega * o.time[i]));
    }
}

/// A sum, row by row: each is drawn from what the filter foresees of it.
void add_summed(const Observable& o, const Predicted& p, const NoiseParameters& noise,
                const std::vector<double>& scale, RandomStream& random, std::vector<double>& y) {
    const double drift = std::exp(noise.carry), nu = std::exp(noise.log_tail), memory = noise.memory;
    Walk walk{};
    Lever lever{};
    double pushed = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double sd = scale[i], arm = of_row(p.lever, i) / sd;
        double value = 0.0;
        if (i == 0 || o.starts[i] != 0) {
            const Beginning first = beginning(o, p, i);
            const double guess = first.guess / sd;
            value = first.rows > 1 ? guess + student(nu, random) : guess;
            walk.begin(value, guess, unsure_of(first.rows, memory));
            lever.begin(arm, p.lever_sd * p.lever_sd);
            pushed = 0.0;
        } else {
            const double gained =
                drift + turned_in(o, i, memory) + (of_row(o.jolt, i) + of_row(p.jolt, i)) / (sd * sd);
            Walk ahead = walk;
            Lever beside = lever;
            double short_of = 0.0;  // of nothing: minus what is foreseen
            const double variance = ahead.filter(0.0, arm, beside, gained, memory, nu, short_of);
            value = -short_of + std::sqrt(variance) * student(nu, random);
            walk.filter(value, arm, lever, gained, memory, nu, short_of);
            pushed += lapse_of(p, i, random);
        }
        y[i] += sd * value + pushed;
    }
}

/// As the instrument shows it.
double shown_as(const Observable& o, const Predicted& p, double value, bool rounds, RandomStream& random) {
    const double floor = o.instrument.floor, step = o.instrument.quantum;
    if (p.ceiling > 0.0 && value > p.ceiling) value = p.ceiling + p.pile * random.normal();
    if (rounds) value = o.y.front() + step * std::nearbyint((value - o.y.front()) / step);
    if (p.floor > 0.0 && value < p.floor) return std::isnan(floor) ? 0.0 : floor;
    return o.instrument.clipped(value);
}

}  // namespace

std::vector<double> replicated(const Observable& o, const Predicted& p, const NoiseParameters& noise,
                               RandomStream& random) {
    std::vector<double> y = p.mean;
    if (o.noise == NoiseKind::Event) {
        for (double& one : y)
            one = random.uniform() < one ? 1.0 : 0.0;
        return y;
    }
    const bool rounds = keeps_to_step(o);
    // Of the errors of each row in the observable's unit, without what rounding adds to it.
    std::vector<double> scale;
    const double rounding = rounds ? o.instrument.quantum * o.instrument.quantum / 12 : 0.0;
    const RowSize size(o, p, noise);
    for (std::size_t i = 0; i < y.size(); ++i)
        scale.push_back(std::sqrt(std::max(size.at(i) * size.at(i) - rounding, kLeastScale * kLeastScale)));
    if (o.noise == NoiseKind::Level)
        add_summed(o, p, noise, scale, random, y);
    else
        add_carried(o, p, noise, scale, random, y);
    for (double& one : y)
        one = shown_as(o, p, one, rounds, random);
    return y;
}

}  // namespace puckloop::gap
