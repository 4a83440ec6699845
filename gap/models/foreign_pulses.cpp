#include "gap/models/foreign_pulses.h"

#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kJump = 2.5;       // usual differences of repeats
constexpr double kBelieved = 10.0;  // log likelihood ratio, above the number of arcs that are tried
constexpr int kRing = physics::kProximitySensors;

/// ln likelihood of `yes` events in `of`, at their own rate.
double fit(double yes, double of) {
    return yes <= 0 || yes >= of ? 0.0 : yes * std::log(yes / of) + (of - yes) * std::log1p(-yes / of);
}

}  // namespace

ForeignPulses foreign_pulses(const Observable& readings, const std::vector<int>& sensor,
                             const std::vector<double>& distance, const std::vector<double>& angle) {
    ForeignPulses pulses;
    std::vector<double> sizes, beyond;
    std::vector<std::pair<std::size_t, double>> repeats;  // sensor, difference
    for (std::size_t i = 1; i < readings.y.size(); ++i)
        if (readings.starts[i] == 0 && distance[i] == distance[i - 1] && angle[i] == angle[i - 1]) {
            sizes.push_back(std::abs(readings.y[i] - readings.y[i - 1]));
            repeats.emplace_back(static_cast<std::size_t>(sensor[i]), sizes.back());
        }
    if (sizes.size() < 2 * kRing) return pulses;
    const double limit = kJump * stats::kMadToSigma * std::max(stats::upper_median(sizes), 1.0);
    std::array<double, kRing> jumps{}, counts{};
    for (const auto& [one, size] : repeats) {
        counts[one] += 1;
        jumps[one] += size > limit ? 1 : 0;
        if (size > limit) beyond.push_back(size);
    }
    if (!beyond.empty()) pulses.size = stats::upper_median(beyond);
    double best = kBelieved;
    int first = 0, length = kRing;
    for (int from = 0; from < kRing; ++from)
        for (int wide = 1; wide < kRing; ++wide) {
            double in = 0, in_of = 0, out = 0, out_of = 0;
            for (int k = 0; k < kRing; ++k) {
                const auto s = static_cast<std::size_t>((from + k) % kRing);
                (k < wide ? in : out) += jumps[s];
                (k < wide ? in_of : out_of) += counts[s];
            }
            if (in_of == 0 || out_of == 0 || in * out_of <= out * in_of) continue;
            const double ratio = fit(in, in_of) + fit(out, out_of) - fit(in + out, in_of + out_of);
            if (ratio <= best) continue;
            best = ratio;
            first = from;
            length = wide;
        }
    for (int s = 0; s < kRing; ++s)
        pulses.sheltered[static_cast<std::size_t>(s)] = (s - first + kRing) % kRing >= length;
    return pulses;
}

}  // namespace puckloop::gap
