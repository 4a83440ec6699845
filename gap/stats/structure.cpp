#include "gap/stats/structure.h"

#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::gap::stats {

namespace {

constexpr std::size_t kRowsAfterReversal = 5;

bool has_both_signs(const std::vector<double>& values) {
    return std::ranges::any_of(values, [](double v) { return v > 0; }) &&
           std::ranges::any_of(values, [](double v) { return v < 0; });
}

std::vector<int> as_labels(const std::vector<double>& values) {
    std::vector<int> labels;
    for (const double v : values)
        labels.push_back(std::isfinite(v) ? static_cast<int>(std::lround(v)) : -1);
    return labels;
}

std::vector<int> signs(const std::vector<double>& values) {
    std::vector<int> sign;
    for (const double v : values)
        sign.push_back(v > 0 ? 2 : v < 0 ? 0 : 1);
    return sign;
}

void test_covariate(const StructureInput& input, const Covariate& c, const TestOptions& options,
                    std::vector<Finding>& table) {
    if (!varies(c.value)) return;
    if (c.kind == CovariateKind::Label) {
        table.push_back(group_test(input.residual, as_labels(c.value), c.name, c.labels, options));
        return;
    }
    table.push_back(trend_test(input.residual, c.value, c.name, options));
    table.push_back(shape_test(input.residual, c.value, c.name, options));
    table.push_back(step_test(input.residual, c.value, c.name, options));
    if (c.kind == CovariateKind::Signed && has_both_signs(c.value)) {
        table.push_back(group_test(input.residual, signs(c.value), "sign of " + c.name,
                                   {"negative", "zero", "positive"}, options));
        table.push_back(reversal_test(input.residual, c.value, c.name, kRowsAfterReversal, options));
    }
}

/// Without the rows at either end of what was measured, where an instrument cuts the scatter off (and
/// without any of what only happens or not).
Series inside(Series residual, const std::vector<double>& raw) {
    if (raw.empty()) return residual;
    const auto [low, high] = std::ranges::minmax_element(raw);
    for (std::size_t i = 0; i < raw.size(); ++i)
        if (raw[i] == *low || raw[i] == *high) residual.value[i] = std::numeric_limits<double>::quiet_NaN();
    return residual;
}

}  // namespace

std::vector<Finding> structure_table(const StructureInput& input, const TestOptions& options) {
    std::vector<Finding> table;
    if (!varies(input.residual.value)) return table;  // rounding of equal means would pass for structure
    for (const Covariate& c : input.covariates)
        test_covariate(input, c, options, table);
    table.push_back(run_order_test(input.residual, options));
    table.push_back(serial_test(input.residual, options));
    if (!input.time.empty()) table.push_back(periodic_test(input.residual, input.time, options));
    table.push_back(outlier_test(input.residual, options));
    table.push_back(evenness_test(inside(input.residual, input.raw), options));
    // How far events scatter follows from how likely they are.
    if (varies(input.level) && !input.residual.events)
        table.push_back(spread_test(input.residual, input.level, "level", options));
    if (!input.raw.empty()) table.push_back(held_test({input.raw, input.residual.run}, options));
    adjust_together({&table, 1});
    return table;
}

std::vector<double> holm(const std::vector<double>& p) {
    const auto order = ordered(p.size(), [&](auto a, auto b) { return p[a] < p[b]; });
    std::vector<double> adjusted(p.size());
    double so_far = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        so_far = std::max(so_far, p[order[i]] * static_cast<double>(p.size() - i));
        adjusted[order[i]] = std::min(so_far, 1.0);
    }
    return adjusted;
}

void adjust_together(std::span<std::vector<Finding>> tables) {
    std::vector<double> p;
    for (const auto& table : tables)
        for (const Finding& f : table)
            p.push_back(f.p);
    const std::vector<double> adjusted = holm(p);
    std::size_t next = 0;
    for (auto& table : tables)
        for (Finding& f : table)
            f.p_adjusted = adjusted[next++];
}

}  // namespace puckloop::gap::stats
