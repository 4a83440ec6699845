#include "tools/gap/selftest/rig.h"

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

double distance_in_noise(const WrittenExperiment& with, const WrittenExperiment& without,
                         const std::vector<NoiseFloor>& floor) {
    double most = 0.0;
    for (const NoiseFloor& noise : floor) {
        double sum = 0.0;
        std::size_t rows = 0;
        for (std::size_t r = 0; r < with.runs.size(); ++r) {
            const WrittenColumn* a = with.runs[r].find(noise.column);
            const WrittenColumn* b = without.runs[r].find(noise.column);
            if (a == nullptr || b == nullptr) continue;
            const std::size_t n = std::min(a->values.size(), b->values.size());
            for (std::size_t k = 0; k < n; ++k) {
                const double d = (a->values[k] - b->values[k]) / noise.sd;
                if (!std::isfinite(d)) continue;
                sum += d * d;
                ++rows;
            }
        }
        if (rows > 0) most = std::max(most, std::sqrt(sum / static_cast<double>(rows)));
    }
    return most;
}

}  // namespace puckloop::gap::selftest
