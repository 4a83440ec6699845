#include "physics/robot/extension.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

/// Between which two places a value is, and how far on.
struct Between {
    std::size_t below = 0;
    double share = 0.0;
};

Between between(const std::vector<double>& at, double value) {
    if (!(value > at.front())) return {0, 0.0};
    if (value >= at.back()) return {at.size() - 2, 1.0};
    const auto above = std::ranges::upper_bound(at, value);
    const auto below = static_cast<std::size_t>(above - at.begin()) - 1;
    return {below, (value - at[below]) / (at[below + 1] - at[below])};
}

double value_at(const ExtensionTerm& term, const std::array<double, 2>& where) {
    if (term.over.empty()) return term.value.front();
    const Between a = between(term.over[0].at, where[0]);
    if (term.over.size() == 1) return (1 - a.share) * term.value[a.below] + a.share * term.value[a.below + 1];
    const Between b = between(term.over[1].at, where[1]);
    const std::size_t width = term.over[1].at.size();
    const auto row = [&](std::size_t first) {
        const double* values = &term.value[first * width + b.below];
        return (1 - b.share) * values[0] + b.share * values[1];
    };
    return (1 - a.share) * row(a.below) + a.share * row(a.below + 1);
}

}  // namespace

Extension::Extension(const std::vector<ExtensionTerm>& terms, std::uint64_t seed, const std::string& robot) {
    RandomStream offsets(seed, "physics/" + robot + "/extension");
    for (const ExtensionTerm& term : terms) {
        const std::size_t quantity = index_of(*extended_named(term.adds_to));
        Table table{term, {}, -1, {}};
        for (std::size_t k = 0; k < term.over.size(); ++k)
            table.over[k] = *known_named(term.over[k].over);
        if (!term.times.empty()) table.times = static_cast<int>(*known_named(term.times));
        for (int sensor = 0; sensor < extended_quantities()[quantity].sensors; ++sensor)
            table.offset.push_back(term.run_spread > 0 ? term.run_spread * offsets.normal() : 0.0);
        terms_[quantity].push_back(std::move(table));
    }
}

bool Extension::asks(Extended quantity, Known covariate) const {
    return std::ranges::any_of(terms_[index_of(quantity)], [&](const Table& table) {
        const auto end = table.over.begin() + static_cast<std::ptrdiff_t>(table.term.over.size());
        return table.times == static_cast<int>(covariate) ||
               std::find(table.over.begin(), end, covariate) != end;
    });
}

double Extension::of(Extended quantity, int sensor, const Moment& now) const {
    double sum = 0.0;
    for (const Table& table : terms_[index_of(quantity)]) {
        if (table.term.sensor >= 0 && table.term.sensor != sensor) continue;
        const double factor = table.times < 0 ? 1.0 : now[static_cast<std::size_t>(table.times)];
        const std::array<double, 2> where{now[static_cast<std::size_t>(table.over[0])],
                                          now[static_cast<std::size_t>(table.over[1])]};
        sum += factor * (value_at(table.term, where) + table.offset[static_cast<std::size_t>(sensor)]);
    }
    return sum;
}

}  // namespace puckloop::physics
