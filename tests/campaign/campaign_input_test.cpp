// What a user may get wrong: one line, status 2, before the first run.

#include "tests/campaign/small_campaign.h"
#include "tests/end_to_end/one_line.h"

#include <catch2/catch.hpp>

using namespace puckloop::tests;

TEST_CASE("a campaign that cannot be is refused in one line before its first run") {
    const Workbench bench;
    std::string good = text_of(small_campaign(bench));
    const auto [from, to, words] = GENERATE(table<std::string, std::string, Words>(
        {{"\"robot0.uart\", from", "\"robot7.uart\", from", {"small.toml", "robot7.uart"}},
         {"\"robot0.pic\", count", "\"robot0.world\", count", {"small.toml", "robot0.world"}},
         {"[\"drop\", \"flip\"]", "[\"drop\", \"melt\"]", {"small.toml", "melt"}},
         {"count = 1 }", "count = 0 }", {"small.toml", "count"}},
         {"count = 1 }", "cuont = 1 }", {"small.toml", "cuont"}},
         {"step = \"200 ms\"", "step = \"0 s\"", {"small.toml", "grid of times"}},
         {"byte = [0, 9, 500]", "byte = [0, -9]", {"small.toml", "byte"}},
         {"duration = \"2.6 s\"", "duration = \"soon\"", {"small.toml", "soon"}},
         {"scenario = \"hello.toml\"", "scenario = \"nowhere.toml\"", {"nowhere.toml"}},
         {"robot = \"robot0\"", "robot = \"robot9\"", {"small.toml", "metric 'path'"}},
         {"[[metric]]", "[[metrik]]", {"small.toml", "metrik"}},
         {"pairs = 3", "pairs = [", {"small.toml"}},
         {"duration = \"2.6 s\"",
          "firmware = [\"robot0.pic=$NOT_SET_ANYWHERE/a.hex\"]",
          {"NOT_SET_ANYWHERE"}}}));
    const auto place = good.find(from);
    REQUIRE(place != std::string::npos);
    const auto file = bench.file("small.toml", good.replace(place, from.size(), to));
    Ended ended = bench.puckloop(campaign_words(bench, file, "bad"));
    // A metric is looked for in the nominal run.
    if (words.back() == "metric 'path'")
        CHECK(ended.status == 2);
    else
        check_one_line(ended, 2, words);
    CHECK(!std::filesystem::exists(bench.out("bad") / "results.csv"));
}

TEST_CASE("files that are no campaign and folders that hold none are refused") {
    const Workbench bench;
    check_one_line(bench.puckloop({"faults", "campaign", bench.out("nothing.toml").string()}), 2,
                   {"nothing.toml"});
    check_one_line(bench.puckloop({"faults", "campaign", bench.folder().string()}), 2, {});
    check_one_line(bench.puckloop({"faults", "show", bench.folder().string()}), 2, {"campaign.db"});
    bench.file("campaign.db", std::string(5000, 'x'));
    check_one_line(bench.puckloop({"faults", "show", bench.folder().string()}), 2, {"campaign.db"});
    check_one_line(bench.puckloop({"faults", "replay", bench.folder().string()}), 2, {"no case"});
}

TEST_CASE("a folder with another campaign's results is not mixed up") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    const std::string table = reference_table(bench, file);
    const std::string other = text_of(file) + "\n# another\n";
    bench.file("small.toml", other);
    check_one_line(bench.puckloop(campaign_words(bench, file, "reference")), 2,
                   {"another campaign", "--fresh"});
    CHECK(table_of(bench, "reference") == table);
    CHECK(bench.puckloop(campaign_words(bench, file, "reference", {"--fresh"})).status == 0);
    CHECK(table_of(bench, "reference") == table);
}
