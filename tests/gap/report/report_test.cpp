// The report is one whole, self-contained page; charts hold what they are given.

#include "base/pages/chart.h"
#include "gap/report/report.h"
#include "gap/report/table.h"
#include "tests/gap/report/made_verdict.h"

#include <catch2/catch.hpp>

#include <regex>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::report;
using Catch::Matchers::Contains;

namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

/// Names of elements that are opened and not closed, in a text without void elements other than meta and br.
std::string unclosed(const std::string& html) {
    std::vector<std::string> open;
    const std::regex tag("<(/?)([a-z0-9]+)([^<>]*)>");
    for (auto it = std::sregex_iterator(html.begin(), html.end(), tag); it != std::sregex_iterator(); ++it) {
        const std::string name = (*it)[2], rest = (*it)[3];
        if (name == "meta" || name == "br" || rest.ends_with("/")) continue;
        if ((*it)[1].length() == 0)
            open.push_back(name);
        else if (open.empty() || open.back() != name)
            return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
        else
            open.pop_back();
    }
    return open.empty() ? "" : open.back();
}

}  // namespace

TEST_CASE("ticks are round numbers that cover the data") {
    const Scale s = Scale::covering(0.13, 9.7);
    CHECK(s.low == 0);
    CHECK(s.high == 10);
    CHECK(s.step == 2);
    CHECK(s.label(4) == "4");
    const Scale fine = Scale::covering(-0.013, 0.011);
    CHECK(fine.low <= -0.013);
    CHECK(fine.high >= 0.011);
    CHECK(fine.label(0.005) == "0.005");
    CHECK(Scale::covering(5, 5).high > 5);
    CHECK(Scale::covering(NAN, NAN).ticks().size() > 2);
}

TEST_CASE("a chart leaves out NaN, thins crowds and names its axes") {
    Chart chart("title < 1", "distance (m)", "reading (counts)");
    std::vector<double> x, y;
    for (int i = 0; i < 10000; ++i)
        x.push_back(i), y.push_back(i % 7 == 0 ? double(NAN) : 1.0 * i);
    chart.points(x, y, "#000000", "measured");
    chart.line({1, 2, 3}, {1, NAN, 3}, "#111111", "before");
    chart.band({1, 2}, {0, 0}, {2, 2}, "#222222");
    const std::string svg = chart.svg(336, 250);
    CHECK(count_of(svg, "<circle") < 1600);
    CHECK(count_of(svg, "<circle") > 1000);
    CHECK(svg.find("nan") == std::string::npos);
    CHECK_THAT(svg, Contains("distance (m)") && Contains("title &lt; 1"));
    CHECK(unclosed(svg) == "");
}

TEST_CASE("an empty chart and one with a single value are still drawn") {
    CHECK(unclosed(Chart("a", "b", "c").svg(300, 200)) == "");
    Chart one("a", "b", "c");
    one.points({1}, {2}, "#000000", "");
    CHECK(one.svg(300, 200).find("nan") == std::string::npos);
}

TEST_CASE("table cells") {
    CHECK(cell(NAN) == "–");
    CHECK(cell(0.123456) == "0.1235");
    CHECK(digits_to_tell(0.1, 0.2, 0.3) == 4);
    CHECK(digits_to_tell(0.0539991, 0.0540012, 0.0540031) == 5);  // 0.053999, 0.054001, 0.054003
    CHECK(digits_to_tell(1.0, 1.0, 1.0) == 4);
    CHECK(p_cell(0.0001) == "< 0.001");
    Table table({"a", "#b"});
    CHECK(table.empty());
    table.row({"x<y", "1"});
    CHECK_THAT(table.html(), Contains("x&lt;y") && Contains("<td class=\"n\">1</td>"));
}

TEST_CASE("the report is whole, self-contained, and says the verdict first") {
    const Experiment e = tests::made_experiment();
    const std::string html = report_html(e, tests::made_verdict(e));
    CHECK(unclosed(html) == "");
    CHECK(html.find("<script") == std::string::npos);
    CHECK(html.find("src=") == std::string::npos);
    CHECK(html.find("href=") == std::string::npos);
    CHECK(count_of(html, "http") == count_of(html, "xmlns=\"http://www.w3.org/2000/svg\""));
    CHECK(html.find("nan") == std::string::npos);
    CHECK(html.find("The cause is named") < html.find("<svg"));
    CHECK_THAT(html,
               Contains("sensor 0 reads 20 % low") && Contains("gain_spread") && Contains("proximity.gain0"));
    CHECK_THAT(html, Contains("six runs, all of one morning") && Contains("Left over, before and after"));
    CHECK_THAT(html,
               Contains("measure a second surface at 2 cm") && Contains("a second object at one distance"));
    CHECK_THAT(html, Contains("The data shows a gain."));
    CHECK(count_of(html, "<svg") >= 4);
    // The structure against the sensor is found before, and is gone after.
    CHECK_THAT(html, Contains("<td>sensor</td>"));
    CHECK(report_html(e, tests::made_verdict(e)) == html);
}

TEST_CASE("posterior-predictive checks are drawn for both models, and alone for the one that stands") {
    using Residual = PredictiveCurve::Residual;
    const Experiment e = tests::made_experiment();
    Verdict v = tests::made_verdict(e);
    CHECK(predictive_svg(v).empty());
    PredictiveCurve law{"marginal law",
                        "measured − simulated",
                        "rows (%)",
                        Residual::Horizontal,
                        {-0.001, 0, 0.001},
                        {20, 60, 20},
                        {15, 50, 15},
                        {25, 70, 25},
                        {},
                        0.62};
    PredictiveCurve mic{"mic <1>",
                        "mic",
                        "measured − simulated",
                        Residual::Vertical,
                        {0, 1, 2},
                        {0.004, NAN, 0.001},
                        {-0.001, NAN, -0.001},
                        {0.001, NAN, 0.001},
                        {"a & b", "c", "d"},
                        0.005};
    v.predictive = {{"x_m", "m", false, 199, {law, mic}}, {"x_m", "m", true, 199, {law}}};
    const std::string html = report_html(e, v);
    CHECK(unclosed(html) == "");
    CHECK(html.find("nan") == std::string::npos);
    CHECK_THAT(html, Contains("Does the fitted model make such data?") &&
                         Contains("the simulator as it is") && Contains("with the named causes") &&
                         Contains("a &amp; b"));
    const std::string svg = predictive_svg(v);
    CHECK(unclosed(svg) == "");
    CHECK_THAT(svg, Contains("marginal law, p = 0.62") && Contains("with the named causes") &&
                        !Contains("the simulator as it is") && !Contains("p = 0.005"));
    v.predictive.pop_back();
    CHECK_THAT(predictive_svg(v), Contains("mic &lt;1&gt;, p = 0.005") && Contains("(mm)"));
    CHECK_THAT(to_json(v), Contains("posterior_predictive") && Contains("\"marginal law\": 0.62"));
}

TEST_CASE("a verdict without causes, series and observables still makes a page") {
    const Experiment e = tests::made_experiment();
    Verdict v;
    v.summary = "The simulator agrees with the data within its noise.";
    const std::string html = report_html(e, v);
    CHECK(unclosed(html) == "");
    CHECK_THAT(html, Contains("No effect found") && Contains("none is claimed"));
}

TEST_CASE("every decision opens the page with what to do next") {
    const Experiment experiment = tests::made_experiment();
    Verdict verdict = tests::made_verdict(experiment);
    const auto steps = [&](Decision decision) {
        verdict.decision = decision;
        const std::string html = report_html(experiment, verdict);
        const auto begin = html.find("What to do next");
        REQUIRE(begin < html.find("class=\"verdict"));
        return html.substr(begin, html.find("</ol>", begin) - begin);
    };
    CHECK_THAT(steps(Decision::Named), Contains("--model overlay.toml") && Contains("no effect"));
    CHECK_THAT(steps(Decision::NoEffect), !Contains("overlay.toml"));
    CHECK_THAT(steps(Decision::Unexplained), Contains("Use no overlay"));
    verdict.leftovers = {{"reading", "distance", 1e-6, "rises with distance"}};
    CHECK_THAT(steps(Decision::Unexplained), Contains("Vary distance alone"));
    for (const char* within : {"run", "course of a run", "stretch of a run", "place in a run"}) {
        verdict.leftovers.front().covariate = within;
        CHECK_THAT(steps(Decision::Unexplained), !Contains("alone") && Contains("repeat one run"));
    }
    verdict.rivals = {{verdict.causes.front(), "", 2.0, "another <surface>"}};
    CHECK_THAT(steps(Decision::CannotTell), Contains("another &lt;surface&gt;"));
    verdict.suggestions = {{"ten more runs", 0.4, {}}};
    CHECK_THAT(steps(Decision::NoEffect), Contains("Record next: ten more runs"));
    verdict.suggestions.push_back({"a longer run", 0.4, {}, 1});
    verdict.suggestions.push_back({"another floor", 0.2, {}, 3});
    CHECK_THAT(steps(Decision::NoEffect),
               Contains("Record next: ten more runs; or, as good: a longer run<") &&
                   !Contains("another floor"));
}
