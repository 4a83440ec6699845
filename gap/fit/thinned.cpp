#include "gap/fit/thinned.h"

#include "base/random.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr std::size_t kStretch = 100;  // rows: long beside what is carried over

Run stretch_of(const Run& run, std::size_t from, std::size_t to) {
    Run part;
    part.name = run.name;
    part.file = run.file;
    part.conditions = run.conditions;
    part.rows = to - from;
    const auto cut = [&](const std::vector<double>& values) {
        return std::vector<double>(values.data() + from, values.data() + to);
    };
    for (const auto& [name, values] : run.columns)
        if (!values.empty()) part.columns.emplace(name, cut(values));
    if (!run.counted_at.empty()) part.counted_at = cut(run.counted_at);
    return part;
}

}  // namespace

Experiment thinned(const Experiment& experiment, std::size_t rows) {
    Experiment part = experiment;
    part.runs.clear();
    // One stretch from somewhere in each slot: evenly over the runs, yet in step with nothing in them.
    RandomStream random(1, "gap/thinned");
    const double share = std::min(
        static_cast<double>(rows) / static_cast<double>(std::max<std::size_t>(experiment.rows(), 1)), 1.0);
    for (const Run& run : experiment.runs) {
        const auto slots = static_cast<std::size_t>(
            std::max(std::round(share * static_cast<double>(run.rows) / kStretch), 1.0));
        const std::size_t slot = run.rows / slots;
        const auto length = std::min<std::size_t>(
            slot, static_cast<std::size_t>(std::ceil(share * static_cast<double>(slot))));
        for (std::size_t k = 0; length > 0 && k < slots; ++k) {
            const std::size_t from = k * slot + random.below(slot - length + 1);
            part.runs.push_back(stretch_of(run, from, from + length));
        }
    }
    return part;
}

}  // namespace puckloop::gap
