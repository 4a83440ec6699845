#include "campaigns/experiment/tables.h"

#include "base/plain_text.h"
#include "base/quantile.h"
#include "campaigns/experiment/progress.h"
#include "campaigns/jobs/result_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace puckloop::swarm {

namespace {

constexpr double kUsual = 0.95;

std::string agreement_text(const Agreement& agreement) {
    std::string text = "against the reference (drop: how much worse its median is)\n";
    for (const Drop& drop : agreement.drops)
        text += fmt::format("  {}{}{}: {:.6g} here, {:.6g} there, drop {:.6g} {}; {}: p {}\n", drop.program,
                            drop.condition.empty() ? "" : ", ", drop.condition, drop.median_here,
                            drop.median_there, drop.drop, interval_text(drop.interval), drop.test.method,
                            p_text(drop.test.p));
    if (std::isfinite(agreement.rank_correlation))
        text += fmt::format("  rank correlation (Spearman) {:.3f} {}\n", agreement.rank_correlation,
                            interval_text(agreement.rank_interval));
    text += fmt::format("  mean error {:.6g} {}, mean absolute error {:.6g} {}\n", agreement.mean_error,
                        interval_text(agreement.error_interval), agreement.mean_absolute,
                        interval_text(agreement.absolute_interval));
    if (!agreement.only_here.empty())
        text += fmt::format("  not in the reference: {}\n", fmt::join(agreement.only_here, "; "));
    if (!agreement.only_there.empty())
        text += fmt::format("  in the reference only: {}\n", fmt::join(agreement.only_there, "; "));
    return text;
}

}  // namespace

std::string table_text(const Findings& findings) {
    std::string text = "run,program,condition,seed,score,failed,simulated_s,trace_sha256\n";
    for (const Run& run : runs_of(findings.experiment)) {
        const auto found = findings.results.find(run.id);
        if (found == findings.results.end()) continue;
        const RunResult& result = found->second;
        text += fmt::format("{},{},{},{},{},{},{:.6f},{}\n", run.id,
                            jobs::csv_cell(findings.experiment.programs[run.program].name),
                            jobs::csv_cell(findings.experiment.conditions[run.condition].name), run.seed,
                            result.score ? fmt::format("{}", *result.score) : std::string(),
                            jobs::csv_cell(result.failed), result.simulated, result.trace);
    }
    return text;
}

std::string interval_text(const statistics::Interval& interval) {
    if (!std::isfinite(interval.low) || !std::isfinite(interval.high)) return "[none]";
    const std::string text = fmt::format("[{:.6g}, {:.6g}]", interval.low, interval.high);
    if (interval.coverage >= kUsual - 1e-9) return text;
    return text + fmt::format(" ({:.1f} %)", 100.0 * interval.coverage);
}

std::string p_text(double p) {
    return p < 0.001 ? std::string("< 0.001") : fmt::format("{:.3f}", p);
}

std::string summary(const Findings& findings, const std::vector<Cell>& cells,
                    const std::vector<Comparison>& comparisons, const std::optional<Agreement>& agreement) {
    const Experiment& experiment = findings.experiment;
    std::string text = fmt::format("score: {} is better; medians with 95 % intervals\n",
                                   more_is_better(findings) ? "more" : "less");
    for (const Cell& cell : cells) {
        const std::vector<double> values = cell.values();
        text += fmt::format("  {}, {}: ", experiment.programs[cell.program].name,
                            experiment.conditions[cell.condition].name);
        text += values.empty() ? std::string("no score")
                               : fmt::format("median {:.6g} {} of {} run{}", median(values),
                                             interval_text(statistics::median_interval(values)),
                                             values.size(), values.size() == 1 ? "" : "s");
        if (cell.failed > 0) text += fmt::format(", {} without a score", cell.failed);
        text += "\n";
    }
    for (const Comparison& comparison : comparisons) {
        text += fmt::format("{} ({} seeds with all scores)\n", comparison.of, comparison.seeds);
        if (comparison.friedman)
            text += fmt::format("  Friedman test: chi-square {:.4g}, {} degrees of freedom, p {}\n",
                                comparison.friedman->chi_square, comparison.friedman->freedom,
                                p_text(comparison.friedman->p));
        for (const Comparison::Pair& pair : comparison.pairs)
            text += fmt::format("  {} - {}: median difference {:.6g} {}; {}: p {}, by Holm {}\n",
                                comparison.treatments[pair.a], comparison.treatments[pair.b], pair.difference,
                                interval_text(pair.interval), pair.test.method, p_text(pair.test.p),
                                p_text(pair.adjusted));
    }
    if (agreement) text += agreement_text(*agreement);
    double wall = 0.0;
    std::size_t failed = 0;
    for (const auto& [id, result] : findings.results) {
        wall += result.wall;
        failed += result.failed.empty() ? 0 : 1;
    }
    if (!findings.results.empty())
        text += fmt::format("{} runs, {:.1f} s each, {} in all{}\n", findings.results.size(),
                            wall / static_cast<double>(findings.results.size()), duration_text(wall),
                            failed == 0 ? std::string() : fmt::format("; {} failed", failed));
    return text + fmt::format("results in {}: report.html, results.csv, experiment.db\n",
                              plain_text(findings.out.string(), kLongestMessage));
}

}  // namespace puckloop::swarm
