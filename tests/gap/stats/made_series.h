#pragma once
// Series of known kind for the tests of the statistics.

#include "base/random.h"
#include "gap/stats/series.h"

#include <cmath>
#include <string>
#include <vector>

namespace puckloop::gap::stats::tests {

/// `runs` runs of `rows` rows: first-order autoregressive noise of unit variance and the given carry-over.
inline Series made_noise(int runs, int rows, double carry, RandomStream& random) {
    Series s;
    for (int r = 0; r < runs; ++r) {
        double v = random.normal();
        for (int i = 0; i < rows; ++i) {
            s.value.push_back(v);
            s.run.push_back(r);
            v = carry * v + std::sqrt(1 - carry * carry) * random.normal();
        }
    }
    return s;
}

/// Slowly wandering covariate, of the same kind as the noise.
inline std::vector<double> made_covariate(int runs, int rows, double carry, RandomStream& random) {
    return made_noise(runs, rows, carry, random).value;
}

inline std::vector<double> made_time(int runs, int rows, double step) {
    std::vector<double> t;
    for (int r = 0; r < runs; ++r)
        for (int i = 0; i < rows; ++i)
            t.push_back(i * step);
    return t;
}

}  // namespace puckloop::gap::stats::tests
