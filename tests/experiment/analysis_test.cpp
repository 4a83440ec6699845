// What is made of scores: cells, comparisons by seed, and agreement with a reference, against counts by hand.

#include "base/error.h"
#include "campaigns/experiment/analysis.h"
#include "campaigns/experiment/box_plot.h"
#include "campaigns/experiment/progress.h"
#include "campaigns/experiment/report.h"
#include "campaigns/experiment/tables.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::swarm;
using Catch::Contains;

namespace {

/// `scores[program][seed - 1]`, NaN for a run that failed.
Findings findings_of(const std::vector<std::vector<double>>& scores) {
    Findings findings;
    findings.experiment.file = "e.toml";
    findings.experiment.scenario = "s.toml";
    for (std::size_t seed = 1; seed <= scores[0].size(); ++seed)
        findings.experiment.seeds.push_back(seed);
    for (std::size_t program = 0; program < scores.size(); ++program)
        findings.experiment.programs.emplace_back().name = std::string(1, static_cast<char>('a' + program));
    findings.experiment.conditions.emplace_back().name = "as it is";
    for (const Run& run : runs_of(findings.experiment)) {
        RunResult result;
        const double score = scores[run.program][run.seed - 1];
        if (std::isnan(score))
            result.failed = "it broke";
        else
            result.score = score;
        result.simulated = 10.0;
        result.wall = 2.0;
        result.trace = "00";
        findings.results[run.id] = result;
    }
    return findings;
}

}  // namespace

TEST_CASE("programs are compared seed by seed, with seeds that all have") {
    const Findings findings = findings_of({{5, 6, 7, 8, NAN}, {1, 2, 3, 4, 9}, {5, 7, 6, 9, 1}});
    const std::vector<Cell> cells = cells_of(findings);
    REQUIRE(cells.size() == 3);
    CHECK(cells[0].failed == 1);
    CHECK(cells[0].values() == std::vector<double>{5, 6, 7, 8});
    const std::vector<Comparison> comparisons = comparisons_of(findings, cells);
    REQUIRE(comparisons.size() == 1);
    const Comparison& comparison = comparisons[0];
    CHECK(comparison.of == "programs, as it is");
    CHECK(comparison.seeds == 4);
    REQUIRE(comparison.friedman);
    // Ranks (2.5, 1, 2.5), (2, 1, 3), (3, 1, 2), (2, 1, 3): sums 9.5, 4, 10.5 of mean 8.
    CHECK(comparison.friedman->chi_square == Approx(12 * (2.25 + 16 + 6.25) / (4 * 3 * 4 - 6 / 2.0)));
    REQUIRE(comparison.pairs.size() == 3);
    CHECK(comparison.pairs[0].difference == 4.0);
    CHECK(comparison.pairs[0].test.p == Approx(2.0 / 16));
    CHECK(comparison.pairs[0].adjusted == Approx(3 * 2.0 / 16));
    CHECK_THAT(summary(findings, cells, comparisons, std::nullopt),
               Contains("a, as it is: median 6.5 [5, 8] (87.5 %) of 4 runs, 1 without a score") &&
                   Contains("Friedman test: chi-square") &&
                   Contains("15 runs, 2.0 s each, 30 s in all; 1 failed"));
    CHECK_THAT(report_html(findings, cells, comparisons, std::nullopt, {}),
               Contains("<svg") && Contains("it broke") && Contains("Friedman test"));
    CHECK_THAT(table_text(findings), Contains("\n5,a,as it is,5,,it broke,10.000000,00\n") &&
                                         Contains("\n6,b,as it is,1,1,,10.000000,00\n"));
}

TEST_CASE("a reference: drop of each program, rank correlation, mean error") {
    const Findings findings = findings_of({{10, 12, 14}, {5, 6, 7}, {1, 2, 3}});
    const std::vector<Cell> cells = cells_of(findings);
    Reference reference;
    reference.scores = {{{"a", ""}, {3, 4, 5}}, {{"b", ""}, {5, 6, 7}}, {{"z", ""}, {1}}};
    const Agreement agreement = agreement_of(findings, cells, reference);
    REQUIRE(agreement.drops.size() == 2);
    CHECK(agreement.drops[0].drop == 8.0);
    CHECK(agreement.drops[0].interval.low <= 8.0);
    CHECK(agreement.drops[0].interval.high >= 8.0);
    CHECK(agreement.drops[0].interval.low >= 5.0);    // 10 - 5
    CHECK(agreement.drops[0].interval.high <= 11.0);  // 14 - 3
    CHECK(agreement.drops[0].test.p == Approx(2.0 / 20));
    CHECK(agreement.drops[1].drop == 0.0);
    CHECK(agreement.rank_correlation == Approx(-1.0));
    CHECK(agreement.mean_error == -4.0);
    CHECK(agreement.mean_absolute == 4.0);
    CHECK(agreement.only_here == std::vector<std::string>{"c"});
    CHECK(agreement.only_there == std::vector<std::string>{"z"});
    Findings less = findings;
    less.experiment.more_is_better = false;
    CHECK(agreement_of(less, cells, reference).drops[0].drop == -8.0);
    reference.scores = {{{"z", ""}, {1}}};
    CHECK_THROWS_WITH(agreement_of(findings, cells, reference), Contains("it has z"));
}

TEST_CASE("a box plot has its quartiles, whiskers and values beyond, and one without values is left out") {
    const std::string svg = box_plot("title", "score", {{"a", {1, 2, 3, 4, 100}}, {"b", {}}, {"c", {2, 2}}});
    CHECK_THAT(svg, Contains("<svg") && Contains("title") && Contains(">a<") && Contains(">b<"));
    // A dot is a path of no length: of 100 there is one.
    CHECK(svg.find("h0") != std::string::npos);
    CHECK(svg.find("h0") == svg.rfind("h0"));
    CHECK(box_plot("", "", {{"a", {1, 2, 3, 4, 5}}}).find("h0") == std::string::npos);
}

TEST_CASE("what is left is estimated from the runs that are there") {
    const Findings findings = findings_of({{1, 2, 3, 4, 5, 6}});
    const std::vector<Run> runs = runs_of(findings.experiment);
    std::map<int, RunResult> done;
    CHECK(Progress(findings.experiment, runs, done, 2).left() < 0.0);
    done[1] = findings.results.at(1);
    done[2] = findings.results.at(2);
    Progress progress(findings.experiment, runs, done, 2);
    CHECK(progress.left() == Approx(2.0 * 4 / 2));
    CHECK_THAT(progress.beginning(),
               Contains("6 runs: 1 program, 1 condition, 6 seeds; 4 run now, 2 at a time, "
                        "about 4 s"));
    RunResult slow = findings.results.at(3);
    slow.wall = 8.0;
    CHECK_THAT(progress.take(3, slow),
               Contains("run 3 of 6: a, as it is, seed 3: score 3 (8.0 s); about 6 s left"));
    CHECK(duration_text(600) == "10 min");
    CHECK(duration_text(9000) == "2.5 h");
}
