#include "gap/fit/filter.h"

#include "gap/fit/walk.h"
#include "gap/stats/tails.h"

#include <Eigen/Core>

#include <cmath>
#include <optional>

namespace puckloop::gap {

namespace {

using Lanes = Eigen::Array<double, static_cast<int>(kLanes), 1>;

constexpr double kClip = 5.0;  // innovations beyond do not pull the filter further
constexpr std::size_t kFirstRows = 5;
constexpr unsigned kLookBack = 5;    // rows: an error is forgotten, a push stays
constexpr double kPileWidths = 3.0;  // from the ceiling: nearer readings were cut to it

/// The lanes' numbers side by side.
template <class Number>
Lanes lanes_of(const Number& number) {
    Lanes lanes;
    for (std::size_t k = 0; k < kLanes; ++k)
        lanes[static_cast<Eigen::Index>(k)] = number(k);
    return lanes;
}

/// Sinusoid of unknown phase: two amplitudes learnt row by row.
struct Line {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity() / 2;

    /// Takes what is known off the innovation, widens its variance, learns from it.
    void filter(const Eigen::Vector2d& h, double& innovation, double& variance) {
        innovation -= h.dot(mean);
        const Eigen::Vector2d gain = covariance * h;
        variance += h.dot(gain);
        const double root = std::sqrt(variance);
        mean += gain * (std::clamp(innovation / root, -kClip, kClip) / root);
        covariance -= gain * gain.transpose() / variance;
    }
};

/// An end of what the instrument shows; `role` Plain: none.
struct End {
    RowRole role = RowRole::Plain;
    double limit = 0.0;
};

/// The end at which the row is.
End end_of(const Observable& o, const Predicted& p, std::size_t i) {
    const bool dead_zone = p.floor > 0.0 && std::isnan(o.instrument.floor);
    if (o.y[i] <= (dead_zone ? 0.0 : o.instrument.floor))
        return {RowRole::Low, p.floor > 0.0 ? p.floor : o.instrument.floor};
    if (o.y[i] >= o.instrument.ceiling) return {RowRole::High, o.instrument.ceiling};
    if (p.ceiling > 0.0 && o.y[i] >= p.ceiling - kPileWidths * p.pile) return {RowRole::Piled, p.ceiling};
    return {};
}

/// Height of the normal density over the tail beyond z.
double hazard(double z) {
    constexpr double kFar = 20.0;  // beyond, the tail runs out; the series is exact to 1e-7
    if (z > kFar) return z + 1 / z - 2 / (z * z * z);
    return std::exp(-z * z / 2) * std::sqrt(2 / std::numbers::pi) / std::erfc(z / std::numbers::sqrt2);
}

/// What is known of a row's error in units of its noise: a mean and a variance.
struct Known {
    double mean = 0.0, variance = 0.0;

    /// With a reading that is `off` the mean, and has an error of the variance `other` besides.
    Known after(double off, double other) const {
        const double taken = variance > 0 ? variance / (variance + other) : 0.0;
        return {mean + taken * off, variance * (1 - taken)};
    }
    /// Learns that the error lies beyond a limit, `z` deviations above the mean (`low`: below it).
    void cut(double z, bool low) {
        const double side = low ? -z : z, steep = hazard(side), sd = std::sqrt(variance);
        mean += low ? -sd * steep : sd * steep;
        variance *= std::clamp(1 + side * steep - steep * steep, 0.0, 1.0);
    }
};

/// What is known of a row's error where the row may be a lapse, which is none of the noise's and tells the
/// next row nothing: mean and variance over "a lapse" and "none" (Harrison and Stevens, J. R. Stat. Soc. B
/// 38, 1976). `ahead` is what was known before the row, which is `off` that; a lapse is normal about its
/// shift.
Known beside_lapse(const Predicted& p, std::size_t i, double off, double sd, const stats::StudentLaw& law,
                   const Known& ahead) {
    const double root = std::sqrt(ahead.variance);
    const double width = p.lapse_scale[i] / sd, shift = of_row(p.lapse_shift, i) / sd,
                 spread = std::hypot(width, root);
    struct Case {
        double weight;
        Known then;
    };
    std::array<Case, 3> cases{{{(1 - p.lapse[i]) * law.density(off / root) / root, ahead.after(off, 0.0)}}};
    for (const std::size_t k : {1, 2}) {
        if (k == 2 && !p.lapse_both) continue;
        const double rest = k == 1 ? off - shift : off + shift;
        cases[k] = {p.lapse[i] * stats::normal_density(rest, spread) / (p.lapse_both ? 2 : 1),
                    ahead.after(rest, width * width)};
    }
    double all = 0.0;
    Known left;
    for (const Case& one : cases) {
        all += one.weight;
        left.mean += one.weight * one.then.mean;
    }
    if (!(all > 0)) return ahead.after(off, 0.0);
    left.mean /= all;
    for (const auto& [weight, then] : cases)
        left.variance += weight / all * (then.variance + std::pow(then.mean - left.mean, 2));
    return left;
}

/// Is the row at an end of what the instrument shows? Then its role and limit are noted.
bool clipped(const Observable& o, const Predicted& p, std::size_t i, double sd, Innovations& out) {
    const auto [role, limit] = end_of(o, p, i);
    if (role == RowRole::Plain) return false;
    out.role[i] = role;
    out.z[i] = (limit - p.mean[i]) / sd;
    return true;
}

void filter_level(const Observable& o, const Predicted& p, const NoiseParameters& noise, Innovations& out,
                  std::vector<double>* gain) {
    const double drift = std::exp(noise.carry), nu = std::exp(noise.log_tail);
    const RowSize size(o, p, noise);
    const bool pushes = !p.lapse.empty();
    if (pushes) {
        out.mixed.assign(o.y.size(), 0.0);
        out.pushed.assign(o.y.size(), 0.0);
        out.off.assign(o.y.size(), 0.0);
    }
    Walk walk{};
    Lever lever{};
    PushedWalk pushed;
    const bool levered = !p.lever.empty();
    unsigned followed = 0;  // rows of the chain after its first, before this one
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
            const Beginning first = beginning(o, p, i);
            const double guess = first.guess / sd, unsure = unsure_of(first.rows, noise.memory);
            walk.begin(error, guess, unsure);
            lever.begin(of_row(p.lever, i) / sd, p.lever_sd * p.lever_sd);
            if (pushes) pushed.begin(error, guess, unsure, levered ? &lever : nullptr);
            const bool plain = first.rows > 1;
            out.role[i] = plain ? RowRole::Plain : RowRole::First;
            out.z[i] = error - guess;
            if (plain) out.variance[i] = sd * sd;
            if (pushes) out.mixed[i] = (nu + 1) / 2 * std::log1p(out.z[i] * out.z[i] / nu) + std::log(sd);
            carried = true;
            followed = 0;
            continue;
        }
        double innovation = 0.0;
        const double gained =
            turned_in(o, i, noise.memory) + (of_row(o.jolt, i) + of_row(p.jolt, i)) / (sd * sd);
        const double level = walk.level, arm = of_row(p.lever, i) / sd;
        const double unlevered = error - walk.level - noise.memory * walk.error;
        const double variance =
            levered ? walk.filter(error, arm, lever, drift + gained, noise.memory, nu, innovation)
                    : walk.filter(error, drift + gained, noise.memory, nu, innovation);
        if (gain != nullptr && unlevered != 0.0) (*gain)[i] = (walk.level - level) / unlevered;
        out.z[i] = innovation / std::sqrt(variance);
        out.variance[i] = variance * sd * sd;
        if (!pushes) continue;
        const double width = p.lapse_scale[i] / sd;
        const auto row = pushed.filter(error, arm, drift + gained, noise.memory, nu,
                                       {p.lapse[i], of_row(p.lapse_shift, i) / sd, width * width});
        out.z[i] = row.innovation;
        out.mixed[i] = row.cost + std::log(sd);
        out.off[i] = row.off * sd;
        // Whether a row was pushed shows in the rows after it: the last look stays.
        for (unsigned back = 0; back <= std::min(followed, kLookBack); ++back)
            out.pushed[i - back] = pushed.pushed(back);
        ++followed;
    }
}

void filter_carry(const Observable& o, const Predicted& p, const NoiseParameters& noise, Innovations& out) {
    const RowSize size(o, p, noise);
    const bool has_line = p.line_amplitude > 0.0 && !o.time.empty();
    const double omega = 2 * std::numbers::pi * p.line_frequency;
    std::optional<stats::StudentLaw> law;
    if (!p.lapse.empty()) law.emplace(std::exp(noise.log_tail));
    Line line;
    bool carried = false;
    Known last;
    Eigen::Vector2d last_h = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const double sd = size.at(i);
        if (o.starts[i] != 0) {
            carried = false;
            line = Line{};
        }
        const double rows = o.steps.empty() ? 1.0 : o.steps[i];  // more than one over rows that are missing
        const double kept = !carried ? 0.0 : rows > 1 ? std::pow(noise.carry, rows) : noise.carry;
        Known ahead{kept * last.mean, 1 - kept * kept + kept * kept * last.variance};
        if (clipped(o, p, i, sd, out)) {
            carried = !has_line;
            if (has_line) continue;
            out.z[i] = (out.z[i] - ahead.mean) / std::sqrt(ahead.variance);
            ahead.cut(out.z[i], out.role[i] == RowRole::Low);
            last = ahead;
            continue;
        }
        const double error = (o.y[i] - p.mean[i]) / sd;
        double innovation = error - ahead.mean, variance = ahead.variance;
        if (has_line) {
            const double reach = p.line_amplitude * of_row(o.gate, i, 1.0) / sd;
            const Eigen::Vector2d own(reach * std::cos(omega * o.time[i]),
                                      reach * std::sin(omega * o.time[i]));
            line.filter(own - kept * last_h, innovation, variance);
            last_h = own;
            ahead = {error - innovation, variance};
        }
        out.z[i] = innovation / std::sqrt(variance);
        out.variance[i] = variance * sd * sd;
        last = of_row(p.lapse, i) > 0.0 ? beside_lapse(p, i, innovation, sd, *law, ahead) : Known{error, 0.0};
        carried = true;
    }
}

}  // namespace

void Innovations::reset(std::size_t rows) {
    z.resize(rows);
    variance.assign(rows, 1.0);
    role.assign(rows, RowRole::Plain);
    mixed.clear();
    pushed.clear();
    off.clear();
}

Beginning beginning(const Observable& o, const Predicted& p, std::size_t i) {
    std::array<double, kFirstRows> errors;
    std::size_t n = 0;
    for (std::size_t k = i; n < kFirstRows && k < o.y.size() && (k == i || o.starts[k] == 0) &&
                            end_of(o, p, k).role == RowRole::Plain;
         ++k)
        errors[n++] = o.y[k] - p.mean[k];
    const double first = errors[0];
    if (n < kFirstRows) return {first, first, 1.0};
    std::nth_element(errors.begin(), errors.begin() + kFirstRows / 2, errors.end());
    return {first, errors[kFirstRows / 2], static_cast<double>(kFirstRows)};
}

bool is_plain_sum(const Observable& o, const Predicted& p) {
    return o.noise == NoiseKind::Level && p.factor.empty() && p.extra.empty() && p.jolt.empty() &&
           p.lapse.empty() && p.floor <= 0.0 && p.ceiling <= 0.0 && std::isnan(o.instrument.floor) &&
           std::isnan(o.instrument.ceiling);
}

void filter_sums(const Observable& o, const std::array<const Predicted*, kLanes>& predicted,
                 const std::array<NoiseParameters, kLanes>& noise,
                 const std::array<Innovations*, kLanes>& out) {
    const std::size_t n = o.y.size();
    for (Innovations* one : out)
        one->reset(n);
    const Lanes sd = lanes_of([&](std::size_t k) { return RowSize(o, *predicted[k], noise[k]).at(0); }),
                memory = lanes_of([&](std::size_t k) { return noise[k].memory; }),
                drift = lanes_of([&](std::size_t k) { return std::exp(noise[k].carry); }),
                tail = lanes_of([&](std::size_t k) { return std::exp(noise[k].log_tail); }),
                doubt = lanes_of([&](std::size_t k) { return std::pow(predicted[k]->lever_sd, 2); }),
                squared_sd = sd * sd;
    const auto write = [&](std::size_t i, const Lanes& z, const Lanes& variance) {
        for (std::size_t k = 0; k < kLanes; ++k) {
            out[k]->z[i] = z[static_cast<Eigen::Index>(k)];
            out[k]->variance[i] = variance[static_cast<Eigen::Index>(k)];
        }
    };
    WalkOf<Lanes> walk;
    LeverOf<Lanes> lever;
    const bool levered = !predicted[0]->lever.empty();
    for (std::size_t i = 0; i < n; ++i) {
        Lanes arm = Lanes::Zero(), innovation;
        if (levered) arm = lanes_of([&](std::size_t k) { return predicted[k]->lever[i]; }) / sd;
        if (i == 0 || o.starts[i] != 0) {
            std::array<Beginning, kLanes> first;
            for (std::size_t k = 0; k < kLanes; ++k)
                first[k] = beginning(o, *predicted[k], i);
            const double rows = first.back().rows;
            const Lanes error = lanes_of([&](std::size_t k) { return first[k].error; }) / sd,
                        guess = lanes_of([&](std::size_t k) { return first[k].guess; }) / sd;
            walk.begin(error, guess, unsure_of(rows, memory));
            if (levered) lever.begin(arm, doubt);
            write(i, error - guess, rows > 1 ? squared_sd : Lanes(Lanes::Ones()));
            for (Innovations* one : out)
                if (!(rows > 1)) one->role[i] = RowRole::First;
            continue;
        }
        const Lanes error = lanes_of([&](std::size_t k) { return o.y[i] - predicted[k]->mean[i]; }) / sd;
        const Lanes gained = turned_in(o, i, memory) + of_row(o.jolt, i) / squared_sd;
        const Lanes total = levered ? walk.filter(error, arm, lever, drift + gained, memory, tail, innovation)
                                    : walk.filter(error, drift + gained, memory, tail, innovation);
        write(i, innovation / total.sqrt(), total * sd * sd);
    }
}

void filter(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
            Innovations& out, std::vector<double>* gain) {
    const std::size_t n = observable.y.size();
    out.reset(n);
    if (observable.noise == NoiseKind::Event) {
        out.role.assign(n, RowRole::Event);
        for (std::size_t i = 0; i < n; ++i)
            out.z[i] = std::clamp(predicted.mean[i], kLeastProbability, 1 - kLeastProbability);
    } else if (observable.noise == NoiseKind::Level) {
        if (gain != nullptr) gain->assign(n, 0.0);
        filter_level(observable, predicted, noise, out, gain);
    } else {
        filter_carry(observable, predicted, noise, out);
    }
}

}  // namespace puckloop::gap
