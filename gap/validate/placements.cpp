#include "gap/validate/placements.h"

#include "gap/kinds/columns.h"
#include "gap/residuals/residual_structure.h"
#include "gap/stats/noise_floor.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr std::size_t kLeastPlacements = 6, kRowsEach = 10;
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kSameNumber = 1e-6;  // of the spread
constexpr double kClearly = 3.0;      // times what the repeats' scatter makes of a mean

std::string with_unit(double value, const std::string& unit) {
    if (unit == "rad") return stats::plain(value * kDegrees) + " deg";
    return stats::plain(value) + unit_suffix(unit);
}

/// Rows in sequence with the same stimulus in one run.
std::vector<stats::Stretch> placements_of(const Experiment& experiment, const Series& series) {
    std::vector<std::vector<double>> stimuli;
    for (const stats::Covariate& c : covariates_of(experiment, series))
        if (c.name != "time" && c.name != "order") stimuli.push_back(c.value);
    if (stimuli.empty()) return {};
    const std::vector<int> number = stats::stimulus_numbers(stimuli);
    std::vector<stats::Stretch> list;
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] < 0) continue;
        if (list.empty() || list.back().last != i || number[i] != number[i - 1] ||
            series.run[i] != series.run[i - 1])
            list.push_back({i, i, static_cast<int>(series.run[i])});
        list.back().last = i + 1;
    }
    return list;
}

}  // namespace

std::string placement_shape(const Experiment& experiment, const Series& series) {
    if (series.after.size() != series.measured.size()) return {};
    const std::vector<stats::Stretch> placements = placements_of(experiment, series);
    if (placements.size() < kLeastPlacements || placements.size() * kRowsEach > series.measured.size())
        return {};
    std::vector<double> means;
    stats::Series inside;
    for (std::size_t p = 0; p < placements.size(); ++p) {
        std::vector<double> rest;
        for (std::size_t i = placements[p].first; i < placements[p].last; ++i)
            rest.push_back(series.measured[i] - series.after[i]);
        means.push_back(stats::mean(rest));
        for (const double r : rest)
            if (std::isfinite(r)) {
                inside.value.push_back(r - means.back());
                inside.run.push_back(static_cast<int>(p));
            }
    }
    const double between = stats::standard_deviation(means), within = stats::standard_deviation(inside.value);
    const double each = static_cast<double>(inside.size()) / static_cast<double>(placements.size());
    const double by_chance = within * std::sqrt(stats::correlation_length(inside) / each);
    if (!(between > within && between > kClearly * by_chance)) return {};
    return fmt::format("differs from placement to placement by {} (standard deviation of {} placements), "
                       "while repeats at one placement scatter by {}",
                       with_unit(between, series.unit), placements.size(), with_unit(within, series.unit));
}

std::string placement_caution(const Experiment& experiment, const Series& series) {
    const std::string shape = placement_shape(experiment, series);
    if (shape.empty()) return {};
    return fmt::format("what is left of {} {}: no effect explains these offsets; more repeats would not "
                       "help, more placements would",
                       series.observable, shape);
}

std::string circular_caution(const Series& series) {
    const double spread = stats::standard_deviation(series.measured);
    if (!(spread > 0)) return {};
    for (std::size_t i = 0; i < series.measured.size(); ++i)
        if (std::fabs(series.measured[i] - series.before[i]) > kSameNumber * spread) return {};
    return fmt::format("the simulator says every {} to the last digit: its own numbers were taken from this "
                       "data, so the agreement proves nothing",
                       series.observable);
}

}  // namespace puckloop::gap
