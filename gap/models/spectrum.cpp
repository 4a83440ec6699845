#include "gap/models/spectrum.h"

#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostRows = 1500;  // enough to find a line worth naming
constexpr std::size_t kMostFrequencies = 3000;
constexpr double kClip = 4.0;

struct Difference {
    double time, before, value;  // times of the row and of the one before it
    bool starts;
};

/// Cosine and sine of one chain, differenced as the rows are, fitted to its differences.
class Fitted {
  public:
    void take(double cosine, double sine, double value) {
        cc_ += cosine * cosine;
        cs_ += cosine * sine;
        ss_ += sine * sine;
        cv_ += cosine * value;
        sv_ += sine * value;
    }
    /// By how much the sum of squares falls.
    double power() const {
        constexpr double kLeast = 1e-3;  // lines that differencing takes away have none
        const double cc = cc_ + kLeast, ss = ss_ + kLeast;
        return (ss * cv_ * cv_ - 2 * cs_ * cv_ * sv_ + cc * sv_ * sv_) / (cc * ss - cs_ * cs_);
    }

  private:
    double cc_ = 0, cs_ = 0, ss_ = 0, cv_ = 0, sv_ = 0;
};

}  // namespace

Line strongest_line(const Observable& o, const std::vector<double>& mean, double highest) {
    if (o.time.empty()) return {};
    std::vector<Difference> differences;
    std::vector<double> spans, sizes;
    double longest = 0.0, begun = 0.0;
    bool fresh = true;
    for (std::size_t i = 0; i < o.y.size() && differences.size() < kMostRows; ++i) {
        if (o.starts[i] != 0) {
            begun = o.time[i];
            fresh = true;
            continue;
        }
        const double span = o.time[i] - o.time[i - 1];
        if (span <= 0) continue;
        if (!o.gate.empty() && o.gate[i] <= 0) continue;
        spans.push_back(span);
        longest = std::max(longest, o.time[i] - begun);
        differences.push_back(
            {o.time[i], o.time[i - 1], (o.y[i] - mean[i]) - (o.y[i - 1] - mean[i - 1]), fresh});
        sizes.push_back(std::abs(differences.back().value));
        fresh = false;
    }
    if (differences.size() < 16) return {};
    if (highest <= 0) highest = 0.5 / stats::upper_median(spans);
    const double limit = kClip * std::max(stats::upper_median(sizes), 1e-9);
    const auto count = std::min(kMostFrequencies, static_cast<std::size_t>(4 * longest * highest) + 8);
    double best = 0.0, best_power = -1.0;
    for (std::size_t k = 1; k <= count; ++k) {
        const double frequency = highest * static_cast<double>(k) / static_cast<double>(count);
        const double omega = 2 * std::numbers::pi * frequency;
        double power = 0.0;
        Fitted chain;
        for (const Difference& d : differences) {
            if (d.starts) {
                power += chain.power();
                chain = {};
            }
            chain.take(std::cos(omega * d.time) - std::cos(omega * d.before),
                       std::sin(omega * d.time) - std::sin(omega * d.before),
                       std::clamp(d.value, -limit, limit));
        }
        power += chain.power();
        if (power > best_power) {
            best_power = power;
            best = frequency;
        }
    }
    return {best, best_power};
}

}  // namespace puckloop::gap
