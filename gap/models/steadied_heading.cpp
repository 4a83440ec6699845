#include "gap/models/steadied_heading.h"

#include <cmath>
#include <cstddef>

namespace puckloop::gap {

void heading_errors(std::span<const double> above, std::span<const double> time, double span,
                    std::vector<double>& errors) {
    const std::size_t n = above.size();
    errors.assign(n, 0.0);
    thread_local std::vector<double> sums, weights;
    sums.resize(n);
    weights.resize(n);
    double sum = 0.0, weight = 0.0, kept = 0.0, step = -1.0;
    const auto fade = [&](double seconds) {
        if (seconds != step) kept = std::exp(-(step = seconds) / span);
        sum *= kept;
        weight *= kept;
    };
    for (std::size_t i = 0; i < n; ++i) {
        if (i > 0) fade(time[i] - time[i - 1]);
        sums[i] = sum += above[i];
        weights[i] = weight += 1.0;
    }
    sum = weight = 0.0;
    for (std::size_t i = n; i-- > 0;) {
        errors[i] = above[i] - (sums[i] + sum) / (weights[i] + weight);
        sum += above[i];
        weight += 1.0;
        if (i > 0) fade(time[i] - time[i - 1]);
    }
}

}  // namespace puckloop::gap
