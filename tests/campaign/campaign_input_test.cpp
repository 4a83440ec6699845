// What a user may get wrong: one line, status 2, before the first run.

#include "tests/campaign/small_campaign.h"
#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <cstdlib>

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
         {"robot = \"robot0\"", "log = \"robot0.linux\"", {"small.toml", "lines"}},
         {"robot = \"robot0\"", "robot = \"robot0\"\nlog = \"robot0.linux\"\nlines = \"x\"", {"one of"}},
         {"/epuck.hex", "/nothing.hex", {"nothing.hex", "no such file"}},
         {"pairs = 3", "pairs = [", {"small.toml"}},
         // What only the board or the bus can know.
         {"[[sweep]]\nname = \"cable\"",
          "[[sweep]]\nfault = { node = \"robot0.pic\", kind = \"flip\", space = \"register\", at = \"2 s\" "
          "}\n"
          "over = { symbol = [\"U2BRG\", \"U9BRG\"] }\n[[sweep]]\nname = \"cable\"",
          {"small.toml", "line 28", "U9BRG"}},
         {"[[sweep]]\nname = \"cable\"",
          "[[sweep]]\nfault = { link = \"robot0.i2c\", kind = \"nack\", phase = \"read\" }\n"
          "[[sweep]]\nname = \"cable\"",
          {"small.toml", "line 28", "acknowledged by its master"}},
         {"$PUCKLOOP_TEST_IMAGES", "$NOT_SET_ANYWHERE", {"NOT_SET_ANYWHERE"}}}));
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

TEST_CASE("a campaign whose cases would not be independent is refused") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    std::string scenario = text_of(bench.folder() / "hello.toml");
    scenario.insert(scenario.find("[robot.linux]"), "nvm = \"robot0.nvm\"\n");
    bench.file("hello.toml", scenario);
    check_one_line(bench.puckloop(campaign_words(bench, file, "bad")), 2, {"hello.toml", "robot0", "nvm"});
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
    bench.file("small.toml", text_of(file).substr(0, other.size() - 11));
    // So is one whose images have other contents at the same place.
    const auto images = bench.out("images");
    std::filesystem::create_directory(images);
    ::setenv(kImages, images.c_str(), 1);
    const std::string image = text_of(PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex");
    bench.file("images/epuck.hex", image);
    CHECK(bench.puckloop(campaign_words(bench, file, "reference", {"--fresh"})).status == 0);
    bench.file("images/epuck.hex", image + "\n");
    check_one_line(bench.puckloop(campaign_words(bench, file, "reference")), 2,
                   {"another campaign", "an image or program"});
    CHECK(table_of(bench, "reference") == table);
    CHECK(bench.puckloop(campaign_words(bench, file, "reference", {"--fresh"})).status == 0);
    CHECK(table_of(bench, "reference") == table);
}
