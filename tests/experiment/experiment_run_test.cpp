// Whole experiments with the shipped swarm: the same table with any number of workers and after a kill, the
// score of a run in every placement, and a run of the ARGoS file with a mission from elsewhere.

#include "campaigns/experiment/experiment_store.h"
#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/process.h"
#include "tests/experiment/small_experiment.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Contains;

namespace {

std::string table_of(const Workbench& bench, const std::string& out) {
    return text_of(bench.out(out) / "results.csv");
}

std::size_t results_in(const std::filesystem::path& out) {
    try {
        return swarm::ExperimentStore(out / "experiment.db", swarm::ExperimentStore::Access::Read)
            .results()
            .size();
    } catch (const std::exception&) {
        return 0;  // not there yet
    }
}

}  // namespace

TEST_CASE(
    "an experiment's table is the same with more workers and after a kill, and its report has the tests") {
    const Workbench bench;
    const auto file = small_experiment(bench);
    const Ended whole = bench.puckloop(experiment_words(bench, file, "one", {"--jobs", "1"}));
    INFO(whole.out << whole.err);
    REQUIRE(whole.status == 0);
    CHECK_THAT(whole.err, Contains("6 runs: 2 programs, 1 condition, 3 seeds; 6 run now") &&
                              Contains("run 6 of 6: still, as it is, seed 3: score") && Contains(" left"));
    CHECK_THAT(whole.out, Contains("more is better") && Contains("aggregate, as it is: median ") &&
                              Contains("Wilcoxon signed-rank, exact: p") && Contains("6 runs, "));
    const std::string table = table_of(bench, "one");
    CHECK(std::count(table.begin(), table.end(), '\n') == 7);
    CHECK_THAT(table, Contains("1,aggregate,as it is,1,") && Contains("6,still,as it is,3,"));
    const std::string html = text_of(bench.out("one") / "report.html");
    CHECK_THAT(html, Contains("<svg") && Contains("Wilcoxon signed-rank, exact") && Contains("</html>") &&
                         !Contains("<script"));
    CHECK_FALSE(std::filesystem::exists(bench.out("one") / "work"));

    {
        const auto killed = bench.start(experiment_words(bench, file, "two", {"--jobs", "2"}));
        while (results_in(bench.out("two")) < 2 && runs(killed->id()))
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        killed->signal(SIGKILL);
        killed->wait();
    }
    const std::size_t kept = results_in(bench.out("two"));
    CHECK(kept >= 2);
    const Ended rest = bench.puckloop(experiment_words(bench, file, "two", {"--jobs", "2"}));
    INFO(rest.err);
    REQUIRE(rest.status == 0);
    CHECK_THAT(rest.err, Contains(fmt::format("{} run now", 6 - kept)));
    CHECK(table_of(bench, "two") == table);

    // Each program once more, as another model's scores: no difference, and it is found for a shifted one.
    std::string other = "program,score\n";
    for (const Row& row : bench.csv("one", "results.csv"))
        other += fmt::format("{},{}\n", row.at("program"), std::stod(row.at("score")) - 1.5);
    const auto against = bench.file("other.csv", other);
    const Ended beside =
        bench.puckloop(experiment_words(bench, file, "one", {"--against", against.string()}));
    INFO(beside.out << beside.err);
    CHECK(beside.status == 0);
    CHECK_THAT(beside.err, Contains("0 run now"));
    CHECK_THAT(beside.out, Contains("drop 1.5 [") && Contains("mean error -1.5 ["));
    CHECK_THAT(text_of(bench.out("one") / "report.html"), Contains("Against other.csv"));
}

TEST_CASE("seeds and duration of the command line are those of workers, of the folder and of --again") {
    const Workbench bench;
    const auto file = small_experiment(bench);
    const Ended whole = bench.puckloop(
        experiment_words(bench, file, "e", {"--jobs", "2", "--seeds", "1", "--duration", "1 s"}));
    INFO(whole.out << whole.err);
    REQUIRE(whole.status == 0);
    CHECK_THAT(whole.err, Contains("2 runs: 2 programs, 1 condition, 1 seed"));
    CHECK(bench.csv("e", "results.csv").size() == 2);
    const Ended again = bench.puckloop({"experiment", bench.out("e").string(), "--again", "2"});
    INFO(again.err);
    CHECK(again.status == 0);
    CHECK(bench.report("e/replay/2")["simulated_s"].get<double>() < 1.5);
    // Without them it is another experiment, whose results are not mixed with these.
    check_one_line(bench.puckloop(experiment_words(bench, file, "e", {})), 2, {"--seeds", "--fresh"});
    check_one_line(bench.puckloop({"experiment", bench.out("e").string(), "--again", "2", "--seeds", "3"}), 2,
                   {"--again"});
}

TEST_CASE("a run's score is the same in every placement, in the report and on the terminal") {
    const Workbench bench;
    const Words words{PUCKLOOP_SOURCE "/scenarios/aggregation.toml", "--set", "robots=3", "--duration",
                      "2.5"};
    Words inside = words;
    inside.push_back("--in-process");
    const Ended one = bench.run("inside", inside), two = bench.run("apart", words);
    INFO(one.err << two.err);
    REQUIRE(one.status == 0);
    REQUIRE(two.status == 0);
    const auto mission = bench.report("inside")["mission"];
    CHECK(mission == bench.report("apart")["mission"]);
    CHECK(mission["kind"] == "aggregation");
    CHECK(mission["steps"] == 15);  // from 1 s to 2.5 s
    CHECK(bench.report("inside")["trace_sha256"] == bench.report("apart")["trace_sha256"]);
    // Counted again from the places that the run recorded.
    double robots_in_spot = 0.0;
    for (const Row& row : bench.csv("inside", "trajectory.csv"))
        if (std::stod(row.at("t_s")) > 1.05 && std::stod(row.at("t_s")) < 2.55 &&
            std::hypot(std::stod(row.at("x_m")), std::stod(row.at("y_m")) - 0.6) <= 0.3)
            ++robots_in_spot;
    CHECK(mission["score"] == robots_in_spot);
    CHECK_THAT(one.out,
               Contains(fmt::format("mission aggregation: score {:g} (more is better), 15 steps of 0.1 s",
                                    robots_in_spot)));
}

TEST_CASE(
    "an ARGoS file is an experiment with a mission of another file, and every run has its folder if asked") {
    const Workbench bench;
    const auto file =
        bench.file("argos.toml", "[experiment]\nscenario = \"" PUCKLOOP_SOURCE
                                 "/scenarios/aggregation.argos\"\nmission = \"" PUCKLOOP_SOURCE
                                 "/scenarios/aggregation.toml\"\nduration = \"1.5 s\"\nseeds = [4]\n"
                                 "keep = true\n[[program]]\nname = \"wander\"\nlinux = "
                                 "[\"/bin/sh\", \"-c\", \"exec " PUCKLOOP_CONTROL
                                 " --behaviour wander\"]\n");  // without -c FILE
    const Ended ended = bench.puckloop(experiment_words(bench, file, "argos"));
    INFO(ended.out << ended.err);
    REQUIRE(ended.status == 0);
    const auto report = nlohmann::json::parse(text_of(bench.out("argos") / "runs" / "1" / "report.json"));
    CHECK(report["mission"]["steps"] == 5);
    CHECK(report["seed"] == 4);
    CHECK(std::stod(bench.csv("argos", "results.csv").at(0).at("score")) == report["mission"]["score"]);
}

TEST_CASE("a run that fails is a row without a score, and status 1") {
    const Workbench bench;
    const auto file = bench.file(
        "failing.toml", "[experiment]\nscenario = \"" PUCKLOOP_SOURCE
                        "/scenarios/aggregation.toml\"\nduration = \"2 s\"\nseeds = 1\n[[program]]\n"
                        "name = \"idle\"\nset = { robots = 1 }\nlinux = [\"/bin/sleep\", \"100\"]\n");
    const Ended ended = bench.puckloop(experiment_words(bench, file, "failing"));
    INFO(ended.out << ended.err);
    CHECK(ended.status == 1);
    CHECK_THAT(ended.out, Contains("no score, 1 without a score") && Contains("1 failed"));
    CHECK_THAT(table_of(bench, "failing"), Contains("1,idle,as it is,1,,") && Contains("never opened"));
    CHECK_THAT(text_of(bench.out("failing") / "report.html"), Contains("Runs that failed"));
}

TEST_CASE("bad input of an experiment is one line and status 2, and nothing is run") {
    const Workbench bench;
    const auto refused = [&](const std::string& text, const Words& more = {}) {
        const auto file = bench.file("bad.toml", text);
        const Ended ended = bench.puckloop(experiment_words(bench, file, "bad", more));
        INFO(ended.out << ended.err);
        CHECK(ended.status == 2);
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
        CHECK_FALSE(std::filesystem::exists(bench.out("bad")));
        return ended.err;
    };
    const std::string head =
        "[experiment]\nscenario = \"" PUCKLOOP_SOURCE "/scenarios/aggregation.toml\"\nseeds = 2\n";
    CHECK_THAT(refused(head + "[[program]]\nname = \"a\"\nset = { robts = 3 }\n"),
               Contains("bad.toml: line 4: 'a' under 'as it is': ") && Contains("robts"));
    CHECK_THAT(refused(head + "[[program]]\nname = \"a\"\nlinux = [\"./nowhere\"]\n"), Contains("nowhere"));
    CHECK_THAT(refused(head + "[[condition]]\nname = \"a\"\nmodel = \"none.toml\"\n"),
               Contains("bad.toml: line ") && Contains("none.toml"));
    CHECK_THAT(refused("[experiment]\nscenario = \"" PUCKLOOP_SOURCE "/scenarios/hello.toml\"\nseeds = 1\n"),
               Contains("has no [mission]"));
    CHECK_THAT(refused(head, {"--against", bench.file("a.csv", "robot,score\n1,2\n").string()}),
               Contains("a.csv: line 1: there is no column 'program'"));
}
