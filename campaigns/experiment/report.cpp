#include "campaigns/experiment/report.h"

#include "base/pages/html_page.h"
#include "base/pages/svg.h"
#include "base/quantile.h"
#include "campaigns/experiment/box_plot.h"
#include "campaigns/experiment/progress.h"
#include "campaigns/experiment/tables.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::swarm {

namespace {

std::string number(double value) {
    return std::isfinite(value) ? fmt::format("<td class=n>{:.6g}</td>", value) : std::string("<td></td>");
}

std::string text_cell(const std::string& text) {
    return "<td>" + escaped(text) + "</td>";
}

std::string head_row(std::initializer_list<const char*> names) {
    std::string row = "<tr>";
    for (const char* name : names)
        row += fmt::format("<th scope=col>{}</th>", name);
    return row + "</tr>\n";
}

std::string plots(const Findings& findings, const std::vector<Cell>& cells) {
    std::string html;
    const Experiment& experiment = findings.experiment;
    for (std::size_t condition = 0; condition < experiment.conditions.size(); ++condition) {
        std::vector<std::pair<std::string, std::vector<double>>> samples;
        for (std::size_t program = 0; program < experiment.programs.size(); ++program)
            samples.emplace_back(experiment.programs[program].name,
                                 cell_of(cells, program, condition).values());
        html += "<div class=wide>" +
                box_plot(experiment.conditions[condition].name,
                         more_is_better(findings) ? "score (more is better)" : "score (less is better)",
                         samples) +
                "</div>\n";
    }
    return html;
}

std::string scores(const Findings& findings, const std::vector<Cell>& cells) {
    std::string html =
        "<h2>Scores</h2>\n<p>Intervals of medians are between order statistics: 95 % or more, where no other "
        "coverage is given.</p>\n<table>" +
        head_row({"program", "condition", "runs", "without a score", "median", "interval", "quartiles",
                  "least", "most", "mean", "s per run"});
    for (const Cell& cell : cells) {
        const std::vector<double> values = cell.values();
        double sum = 0.0;
        for (const double value : values)
            sum += value;
        const std::size_t runs = values.size() + cell.failed;
        html +=
            "<tr>" + text_cell(findings.experiment.programs[cell.program].name) +
            text_cell(findings.experiment.conditions[cell.condition].name) +
            fmt::format("<td class=n>{}</td><td class=n>{}</td>", values.size(), cell.failed) +
            number(median(values)) +
            text_cell(values.empty() ? std::string() : interval_text(statistics::median_interval(values))) +
            text_cell(values.empty()
                          ? std::string()
                          : fmt::format("{:.6g}, {:.6g}", quantile(values, 0.25), quantile(values, 0.75))) +
            number(quantile(values, 0.0)) + number(quantile(values, 1.0)) +
            number(sum / static_cast<double>(values.size())) + number(cell.wall / static_cast<double>(runs)) +
            "</tr>\n";
    }
    return html + "</table>\n";
}

std::string tests(const std::vector<Comparison>& comparisons) {
    if (comparisons.empty()) return {};
    std::string html = "<h2>Comparisons</h2>\n<p>Runs with the same seed are pairs. Wilcoxon's signed-rank "
                       "test is two-sided, "
                       "zero differences are left out; its p is adjusted by Holm's method over the pairs of "
                       "a table. Friedman's "
                       "test has the seeds as blocks, with the chi-square approximation.</p>\n";
    for (const Comparison& comparison : comparisons) {
        html += fmt::format("<h3>{}</h3>\n<p>{} seeds have a score for each.", escaped(comparison.of),
                            comparison.seeds);
        if (comparison.friedman)
            html += fmt::format(" Friedman test: chi-square {:.4g}, {} degrees of freedom, p {}.",
                                comparison.friedman->chi_square, comparison.friedman->freedom,
                                escaped(p_text(comparison.friedman->p)));
        html += "</p>\n<table>" + head_row({"pair", "median difference", "interval", "test", "statistic", "n",
                                            "p", "p by Holm"});
        for (const Comparison::Pair& pair : comparison.pairs)
            html += "<tr>" +
                    text_cell(comparison.treatments[pair.a] + " - " + comparison.treatments[pair.b]) +
                    number(pair.difference) + text_cell(interval_text(pair.interval)) +
                    text_cell(pair.test.method) + number(pair.test.statistic) +
                    fmt::format("<td class=n>{}</td>", pair.test.n) + text_cell(p_text(pair.test.p)) +
                    text_cell(p_text(pair.adjusted)) + "</tr>\n";
        html += "</table>\n";
    }
    return html;
}

std::string list(const char* what, const std::vector<std::string>& names) {
    if (names.empty()) return {};
    std::string html = fmt::format("<p>{}: ", what);
    for (std::size_t i = 0; i < names.size(); ++i)
        html += (i == 0 ? "" : "; ") + escaped(names[i]);
    return html + "</p>\n";
}

std::string agreement_html(const Agreement& agreement, const std::filesystem::path& against) {
    std::string html = fmt::format("<h2>Against {}</h2>\n<p>The drop is how much worse the reference's "
                                   "median is; intervals are percentile "
                                   "bootstraps of 2000 draws, 95 %.</p>\n<table>",
                                   escaped(against.filename().string()));
    html += head_row({"program", "condition", "runs here", "runs there", "median here", "median there",
                      "drop", "interval", "test", "U", "p"});
    for (const Drop& drop : agreement.drops)
        html += "<tr>" + text_cell(drop.program) + text_cell(drop.condition) +
                fmt::format("<td class=n>{}</td><td class=n>{}</td>", drop.here, drop.there) +
                number(drop.median_here) + number(drop.median_there) + number(drop.drop) +
                text_cell(interval_text(drop.interval)) + text_cell(drop.test.method) +
                number(drop.test.statistic) + text_cell(p_text(drop.test.p)) + "</tr>\n";
    html += "</table>\n<table>" + head_row({"over all programs", "value", "interval"});
    const auto row = [&](const char* name, double value, const statistics::Interval& interval) {
        if (std::isfinite(value))
            html += fmt::format("<tr><td>{}</td>{}{}</tr>\n", name, number(value),
                                text_cell(interval_text(interval)));
    };
    row("rank correlation of medians (Spearman)", agreement.rank_correlation, agreement.rank_interval);
    row("mean error (reference minus here)", agreement.mean_error, agreement.error_interval);
    row("mean absolute error", agreement.mean_absolute, agreement.absolute_interval);
    return html + "</table>\n" + list("Not in the reference", agreement.only_here) +
           list("In the reference only", agreement.only_there);
}

/// The cells that say which run it is.
std::string run_cells(const Findings& findings, const Run& run) {
    return text_cell(findings.experiment.programs[run.program].name) +
           text_cell(findings.experiment.conditions[run.condition].name) +
           fmt::format("<td class=n>{}</td>", run.seed);
}

/// With links to their pages.
std::string all_runs(const Findings& findings, const PageOfRun& page) {
    std::string html = "<h2>Runs</h2>\n<p>A number opens the run in the viewer.</p>\n<table>" +
                       head_row({"run", "program", "condition", "seed", "score"});
    for (const Run& run : runs_of(findings.experiment)) {
        const auto found = findings.results.find(run.id);
        if (found == findings.results.end()) continue;
        html += fmt::format("<tr><td class=n><a href=\"{}\">{}</a></td>", escaped(page(run)), run.id) +
                run_cells(findings, run) +
                (found->second.score ? number(*found->second.score) : text_cell("none")) + "</tr>\n";
    }
    return html + "</table>\n";
}

std::string failures(const Findings& findings) {
    std::string html;
    for (const Run& run : runs_of(findings.experiment)) {
        const auto found = findings.results.find(run.id);
        if (found == findings.results.end() || found->second.failed.empty()) continue;
        html += fmt::format("<tr><td class=n>{}</td>", run.id) + run_cells(findings, run) +
                text_cell(found->second.failed) + "</tr>\n";
    }
    if (html.empty()) return {};
    return "<h2>Runs that failed</h2>\n<p>Their scores do not count.</p>\n<table>" +
           head_row({"run", "program", "condition", "seed", "why"}) + html + "</table>\n";
}

}  // namespace

std::string report_html(const Findings& findings, const std::vector<Cell>& cells,
                        const std::vector<Comparison>& comparisons, const std::optional<Agreement>& agreement,
                        const std::filesystem::path& against, const PageOfRun& page) {
    const Experiment& experiment = findings.experiment;
    const std::string title = "Experiment " + experiment.file.filename().string();
    std::string html = html_head(title) + fmt::format("<h1>{}</h1>\n", escaped(title));
    double wall = 0.0;
    for (const auto& [id, result] : findings.results)
        wall += result.wall;
    html += fmt::format("<p>Scenario {}, {} runs: {} programs and conditions, {} seeds each. Wall time {}, "
                        "all runs one after the other.</p>\n",
                        escaped(experiment.scenario.string()), findings.results.size(),
                        experiment.programs.size() * experiment.conditions.size(), experiment.seeds.size(),
                        duration_text(wall));
    html += plots(findings, cells) + scores(findings, cells) + tests(comparisons);
    if (agreement) html += agreement_html(*agreement, against);
    html += failures(findings);
    if (page) html += all_runs(findings, page);
    return html + "</body></html>\n";
}

}  // namespace puckloop::swarm
