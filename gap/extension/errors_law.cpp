#include "gap/extension/errors_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kCarries[] = {0.0, 0.2, 0.4, 0.6, 0.75, 0.85, 0.92, 0.96, 0.98, 0.99};
constexpr double kWalks[] = {0.0, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0};
constexpr double kTails[] = {3.0, 5.0, 10.0, 30.0, 1000.0};
constexpr double kOpen = 1e6;      // variance of where a sum begins, in units of the noise's
constexpr int kRoundsOfTails = 9;  // of the size of a heavy-tailed law: it has settled
constexpr double kNoVariance = 1e-300;

double half_log(double value) {
    return std::log(value) / 2;
}

double log_likelihood_of(const Whitening& whitening, const std::vector<double>& z, double sd, double tail) {
    double sum = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < z.size(); ++i)
        if (whitening.scale(i) > 0) {
            sum += std::log1p(z[i] * z[i] / (sd * sd * tail));
            rows += 1;
        }
    return rows * student_log_density(0.0, tail) - (tail + 1) / 2 * sum - rows * std::log(sd) -
           whitening.log_sizes();
}

/// The size of Student's law that these innovations have.
double size_of(const Whitening& whitening, const std::vector<double>& z, double tail) {
    double variance = INFINITY;
    for (int round = 0; round < kRoundsOfTails; ++round) {
        double weighted = 0.0, rows = 0.0;
        for (std::size_t i = 0; i < z.size(); ++i)
            if (whitening.scale(i) > 0) {
                weighted +=
                    (std::isinf(variance) ? 1.0 : (tail + 1) / (tail + z[i] * z[i] / variance)) * z[i] * z[i];
                rows += 1;
            }
        variance = std::max(weighted / std::max(rows, 1.0), kNoVariance);
    }
    return std::sqrt(variance);
}

std::vector<double> whitened(const Whitening& whitening, std::span<const double> errors) {
    std::vector<double> z(errors.begin(), errors.end());
    whitening.apply(z);
    return z;
}

}  // namespace

double student_log_density(double z, double tail) {
    return std::lgamma((tail + 1) / 2) - std::lgamma(tail / 2) - half_log(tail * std::numbers::pi) -
           (tail + 1) / 2 * std::log1p(z * z / tail);
}

Whitening::Whitening(const ErrorsLaw& law, std::span<const char> known, std::span<const char> starts)
    : sums_(law.sums), carry_(law.number) {
    double variance = kOpen, share = 0.0;  // of the sum's own part; of the error before
    bool before = false;
    for (std::size_t i = 0; i < known.size(); ++i) {
        Step step;
        step.begins = starts[i];
        if (starts[i] != 0) {
            variance = kOpen;
            before = false;
        } else if (sums_) {
            variance += law.number;
        }
        if (known[i] != 0) {
            if (sums_) {
                const double size = variance + 1;
                step.gain = variance / size;
                // The first row only says where the sum begins.
                if (variance < kOpen / 2) step.scale = 1 / std::sqrt(size);
                variance = step.gain;
            } else {
                share = before ? 1 - carry_ * carry_ : 1.0;
                step.scale = carry_ < 1 ? 1 / std::sqrt(share / (1 - carry_ * carry_)) : 1.0;
            }
            if (step.scale > 0) log_sizes_ -= std::log(step.scale);
            before = true;
        } else {
            before = false;
        }
        steps_.push_back(step);
    }
}

void Whitening::apply(std::span<double> column) const {
    double level = 0.0, last = 0.0;
    bool before = false;
    for (std::size_t i = 0; i < column.size(); ++i) {
        const Step& step = steps_[i];
        if (step.begins != 0) level = 0.0, before = false;
        const double value = column[i];
        const bool known = step.scale > 0 || step.gain > 0;
        if (sums_) {
            const double innovation = known ? value - level : 0.0;
            level += step.gain * innovation;
            column[i] = innovation * step.scale;
        } else {
            column[i] = known ? (value - (before ? carry_ * last : 0.0)) * step.scale : 0.0;
            last = value;
            before = known;
        }
    }
}

ErrorsLaw law_of(bool sums, std::span<const double> errors, std::span<const char> known,
                 std::span<const char> starts) {
    ErrorsLaw best;
    best.sums = sums;
    double most = -INFINITY;
    const auto grid = sums ? std::span<const double>(kWalks) : std::span<const double>(kCarries);
    for (const double number : grid) {
        ErrorsLaw law;
        law.sums = sums;
        law.number = number;
        const Whitening whitening(law, known, starts);
        const auto z = whitened(whitening, errors);
        for (const double tail : kTails) {
            law.tail = tail;
            law.sd = size_of(whitening, z, tail);
            const double score = log_likelihood_of(whitening, z, law.sd, tail);
            if (score > most) most = score, best = law;
        }
    }
    return best;
}

std::vector<double> row_costs_of(const ErrorsLaw& law, std::span<const double> errors,
                                 std::span<const char> known, std::span<const char> starts) {
    const Whitening whitening(law, known, starts);
    const auto z = whitened(whitening, errors);
    std::vector<double> costs(z.size(), 0.0);
    for (std::size_t i = 0; i < z.size(); ++i)
        if (whitening.scale(i) > 0)
            costs[i] = std::log(law.sd) - std::log(whitening.scale(i)) -
                       student_log_density(z[i] / law.sd, law.tail);
    return costs;
}

}  // namespace puckloop::gap
