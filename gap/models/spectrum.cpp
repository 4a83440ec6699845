#include "gap/models/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostRows = 4000;  // enough to find a line worth naming
constexpr std::size_t kMostFrequencies = 3000;
constexpr double kClip = 4.0;

struct Difference {
    double time, value;
    bool starts;
};

}  // namespace

std::vector<double> strongest_line(const Observable& o, const std::vector<double>& mean) {
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
        spans.push_back(span);
        longest = std::max(longest, o.time[i] - begun);
        const double gate = o.gate.empty() ? 1.0 : o.gate[i];
        differences.push_back({o.time[i], gate * ((o.y[i] - mean[i]) - (o.y[i - 1] - mean[i - 1])), fresh});
        sizes.push_back(std::abs(differences.back().value));
        fresh = false;
    }
    if (differences.size() < 16) return {};
    std::nth_element(spans.begin(), spans.begin() + static_cast<std::ptrdiff_t>(spans.size() / 2),
                     spans.end());
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2),
                     sizes.end());
    const double highest = 0.5 / spans[spans.size() / 2],
                 limit = kClip * std::max(sizes[sizes.size() / 2], 1e-9);
    const auto count = std::min(kMostFrequencies, static_cast<std::size_t>(4 * longest * highest) + 8);
    double best = 0.0, best_power = -1.0;
    for (std::size_t k = 1; k <= count; ++k) {
        const double frequency = highest * static_cast<double>(k) / static_cast<double>(count);
        const double omega = 2 * std::numbers::pi * frequency;
        std::complex<double> sum;
        double power = 0.0;
        for (const Difference& d : differences) {
            if (d.starts) {
                power += std::norm(sum);
                sum = {};
            }
            sum += std::clamp(d.value, -limit, limit) * std::polar(1.0, omega * d.time);
        }
        power += std::norm(sum);
        power /=
            1 - std::cos(omega * spans[spans.size() / 2]) + 1e-3;  // differencing makes high lines stronger
        if (power > best_power) {
            best_power = power;
            best = frequency;
        }
    }
    return {best};
}

}  // namespace puckloop::gap
