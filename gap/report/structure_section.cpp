// Noise floor and structure tests of every observable.

#include "base/pages/svg.h"
#include "gap/findings/quantities.h"
#include "gap/report/sections.h"
#include "gap/report/table.h"
#include "gap/residuals/residual_structure.h"
#include "gap/stats/noise_floor.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap::report {

namespace {

constexpr double kClear = 0.05;         // corrected p
constexpr std::size_t kMostLines = 14;  // an observable
constexpr double kRounding = 1e-9;      // of an error: differences of equal numbers

using stats::Finding;

double rms_of(std::vector<double> values) {
    for (double& value : values)
        value *= value;
    return std::sqrt(stats::mean(values));
}

/// Rows that read the same sensor, receiver or thing follow each other.
std::vector<int> chains_of(const std::vector<stats::Covariate>& covariates, std::size_t rows) {
    std::vector<std::vector<double>> labels;
    for (const stats::Covariate& c : covariates)
        if (c.kind == stats::CovariateKind::Label) labels.push_back(c.value);
    return labels.empty() ? std::vector<int>(rows, 0) : stats::stimulus_numbers(labels);
}

void add_floor(const Experiment& experiment, const Series& series, Table& table) {
    const auto covariates = covariates_of(experiment, series);
    std::vector<std::vector<double>> stimuli;
    for (const stats::Covariate& c : covariates)
        if (c.name != "time" && c.name != "order" && c.name != "session") stimuli.push_back(c.value);
    const std::vector<int> runs(series.run.begin(), series.run.end());
    const std::size_t rows = series.measured.size();
    const bool sums = experiment.kind == Kind::Motion || experiment.kind == Kind::Timing;
    const stats::NoiseFloor floor = stats::noise_floor(
        {series.measured, runs},
        stimuli.empty() || sums ? std::vector<int>(rows, -1) : stats::stimulus_numbers(stimuli));
    const double before = rms_of(left_over(series, Stage::Before));
    double single = stats::row_to_row({left_over(series, Stage::Before), runs}, chains_of(covariates, rows));
    if (single < kRounding * before) single = 0.0;
    if (series.events) single = NAN;  // what happened or not has no size that a difference could give
    table.row({plain_observable(series.observable), unit_cell(series.unit), cell(floor.within_run),
               cell(floor.between_runs), cell(single), cell(before),
               cell(rms_of(left_over(series, Stage::After)))});
}

std::string effect_of(const Finding& f) {
    if (f.effect_unit == "fraction") return fmt::format("{:.2g} %", 100 * f.effect);
    if (!f.effect_unit.empty()) return fmt::format("{:.3g}", f.effect);
    return fmt::format("{:.3g} σ", f.relative);
}

/// The clearest line of either stage for each test and covariate; clear ones first.
std::string tests_of(const std::vector<Finding>& before, const std::vector<Finding>& after) {
    const auto after_of = [&](const Finding& f) -> const Finding* {
        for (const Finding& g : after)
            if (g.test == f.test && g.covariate == f.covariate) return &g;
        return nullptr;
    };
    const auto clearest = [&](std::size_t i) {
        const Finding* later = after_of(before[i]);
        return std::min(before[i].p_adjusted, later != nullptr ? later->p_adjusted : 1.0);
    };
    Table table({"test", "against", "#size before", "#p before", "#size after", "#p after", "shape"});
    std::size_t clear = 0;
    for (const std::size_t i :
         stats::ordered(before.size(), [&](auto a, auto b) { return clearest(a) < clearest(b); })) {
        const Finding& f = before[i];
        const Finding* later = after_of(f);
        if (clearest(i) > kClear || clear >= kMostLines) continue;
        ++clear;
        const bool left = later != nullptr && later->p_adjusted < kClear;
        table.row({f.test, f.covariate, effect_of(f), p_cell(f.p_adjusted),
                   later != nullptr ? effect_of(*later) : "–",
                   later != nullptr ? p_cell(later->p_adjusted) : "–", left ? later->shape : f.shape},
                  left ? "strong" : "");
    }
    const std::string rest = fmt::format("<p class=\"about\">{} of {} tests shown; the others find nothing "
                                         "(corrected p above {}) or less. Bold: still there after.</p>\n",
                                         clear, before.size(), kClear);
    return (table.empty() ? std::string() : table.html()) + rest;
}

}  // namespace

std::string structure_section(const Experiment& experiment, const Verdict& verdict) {
    if (verdict.series.empty()) return {};
    Table floor({"observable", "unit", "#repeats in a run", "#run to run", "#row to row", "#rms before",
                 "#rms after"});
    std::string tests;
    const stats::TestOptions options{.seed = verdict.seed, .permutations = 199};
    std::vector<std::vector<Finding>> before, after;
    for (const Series& series : verdict.series) {
        add_floor(experiment, series, floor);
        before.push_back(residual_structure(experiment, series, Stage::Before, options));
        after.push_back(residual_structure(experiment, series, Stage::After, options));
    }
    stats::adjust_together(before);
    stats::adjust_together(after);
    for (std::size_t i = 0; i < verdict.series.size(); ++i)
        tests += fmt::format("<h3>{}</h3>\n{}", escaped(plain_observable(verdict.series[i].observable)),
                             tests_of(before[i], after[i]));
    return "<h2>Noise floor</h2>\n<p>Standard deviations: of repeats of one stimulus inside a run, of their "
           "means from run to run, and of single rows, from what differs between successive rows of one "
           "sensor or "
           "receiver beyond what the simulator gives; no model can do better than the first two.</p>\n" +
           floor.html() + "<h2>Structure of what is left</h2>\n" + tests;
}

}  // namespace puckloop::gap::report
