#include "selftest/benches/rig.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap::selftest {

WrittenExperiment repeated(std::uint64_t seed, std::size_t least_runs,
                           const std::function<WrittenExperiment(std::uint64_t)>& exact) {
    WrittenExperiment all = exact(seed);
    RandomStream designs(seed, "designs of further runs");
    while (all.runs.size() < least_runs)
        for (WrittenRun& run : exact(designs.next()).runs)
            all.runs.push_back(std::move(run));
    return all;
}

std::vector<double> difference_in_noise(const WrittenRun& with, const WrittenRun& without,
                                        const NoiseFloor& noise) {
    const WrittenColumn *a = with.find(noise.column), *b = without.find(noise.column);
    if (a == nullptr || b == nullptr) return {};
    std::vector<double> all(std::min(a->values.size(), b->values.size()));
    double sum = 0.0, rows = 0.0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k] = (a->values[k] - b->values[k]) / noise.sd;
        if (!std::isfinite(all[k])) continue;
        sum += all[k];
        rows += 1;
    }
    if (noise.any_beginning)
        for (double& one : all)
            one -= sum / rows;
    return all;
}

double distance_in_noise(const WrittenExperiment& with, const WrittenExperiment& without,
                         const std::vector<NoiseFloor>& floor) {
    double most = 0.0;
    for (const NoiseFloor& noise : floor) {
        double sum = 0.0;
        std::size_t rows = 0;
        for (std::size_t r = 0; r < with.runs.size(); ++r)
            for (const double d : difference_in_noise(with.runs[r], without.runs[r], noise)) {
                if (!std::isfinite(d)) continue;
                sum += d * d;
                ++rows;
            }
        if (rows > 0) most = std::max(most, std::sqrt(sum / static_cast<double>(rows)));
    }
    return most;
}

}  // namespace puckloop::gap::selftest
