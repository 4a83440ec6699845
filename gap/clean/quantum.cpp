#include "gap/clean/quantum.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kSame = 1e-9;            // of the range: decimal text read twice
constexpr double kNoRest = 1e-4;          // of a step: what unit conversions and decimals leave of it
constexpr double kOffGrid = 0.02;         // of a step, after many
constexpr std::size_t kLeastValues = 3;   // different ones: two always keep to a step
constexpr double kMostSteps = 1e7;        // of the range: a double's own digits are no instrument's
constexpr std::size_t kLookedAt = 20000;  // values, from all over

/// Do all values lie on the grid?
bool keeps_to(const std::vector<double>& values, double step) {
    return std::all_of(values.begin(), values.end(), [&](double value) {
        const double steps = (value - values.front()) / step;
        return std::abs(steps - std::round(steps)) < kOffGrid;
    });
}

}  // namespace

double quantum_of(const std::vector<double>& values) {
    std::vector<double> known;
    const std::size_t every = values.size() / kLookedAt + 1;
    for (std::size_t i = 0; i < values.size(); i += every)
        if (std::isfinite(values[i])) known.push_back(values[i]);
    if (known.empty()) return 0.0;
    std::sort(known.begin(), known.end());
    const double range = known.back() - known.front();
    known.erase(
        std::unique(known.begin(), known.end(), [&](double a, double b) { return b - a <= kSame * range; }),
        known.end());
    if (known.size() < kLeastValues) return 0.0;
    // Euclid's algorithm on the gaps: what remains of one gap by another shrinks to the common step.
    double step = 0.0;
    for (std::size_t i = 1; i < known.size(); ++i) {
        double gap = known[i] - known[i - 1];
        while (step > 0 && gap > kNoRest * step && gap > range / kMostSteps) {
            const double rest = std::abs(std::remainder(step, gap));
            step = gap;
            gap = rest;
        }
        if (step == 0.0) step = gap;
        if (step < range / kMostSteps) return 0.0;
    }
    // Rounded conversions make the smallest gaps a little off: the mean step over the whole range is exact.
    const double whole = std::round(range / step);
    step = range / whole;
    return keeps_to(known, step) ? step : 0.0;
}

}  // namespace puckloop::gap
