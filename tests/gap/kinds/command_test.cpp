// A kind of one's own on the command line, from the first command to the verdict.

#include "base/random.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/kit/shell.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>

using namespace puckloop::tests;
using Catch::Matchers::Contains;

namespace {

const std::string kGap = std::string(PUCKLOOP_GAP_PROGRAM) + " gap ";

}  // namespace

TEST_CASE("new, check and verdict of a kind that its user described") {
    const auto folder = scratch_path("own kind");
    std::filesystem::create_directories(folder);
    const std::string in = "cd '" + folder.string() + "' && ";
    CHECK(run_in_shell(in + kGap + "new ir_distance.toml begun --runs 2").status ==
          0);  // comes with the program
    CHECK_THAT(text_of(folder / "begun/experiment.toml"), Contains("kind = \"ir_distance.toml\""));
    CHECK_THAT(text_of(folder / "begun/run2.csv"), Contains("temperature_c"));
    CHECK(std::filesystem::exists(folder / "begun/ir_distance.toml"));

    std::ofstream(folder / "tank.toml") << R"toml(name = "tank"
[column.level]
role = "observable"
unit = "V"
range = [-1, 5]
mean = "slope * depth_m + zero"
[column.depth_m]
role = "truth"
unit = "m"
range = [0, 2]
[parameter.slope]
unit = "V/m"
neutral = 1
range = [0.2, 2]
[parameter.zero]
unit = "V"
neutral = 0
range = [0, 1]
[effect.steeper]
title = "the answer is steeper"
parameters = ["slope"]
separated_by = "an empty and a full tank"
[effect.shifted]
title = "the answer has another zero"
parameters = ["zero"]
separated_by = "an empty tank"
)toml";
    const Ran begun = run_in_shell(in + kGap + "new tank.toml tank --runs 6");
    INFO(begun.output);
    REQUIRE(begun.status == 0);
    for (int run = 1; run <= 6; ++run) {
        std::ofstream csv(folder / "tank" / ("run" + std::to_string(run) + ".csv"));
        puckloop::RandomStream random(static_cast<std::uint64_t>(run), "tank");
        csv << "t_s,level,depth_m\n";
        for (int k = 0; k < 40; ++k) {
            const double depth = 2 * random.uniform(), noise = random.normal();
            csv << 0.1 * k << ',' << 1.2 * depth + 0.01 * noise << ',' << depth << '\n';
        }
    }
    const Ran checked = run_in_shell(in + kGap + "check tank");
    INFO(checked.output);
    CHECK(checked.status == 0);
    CHECK_THAT(checked.output, Contains("can be found: steeper, shifted"));
    const Ran verdict = run_in_shell(in + kGap + "tank --out out");
    INFO(verdict.output);
    CHECK(verdict.status == 0);
    CHECK_THAT(verdict.output, Contains("verdict: named") && Contains("tank.slope = 1."));
    const std::string once = "the simulator has no tank";
    const auto first = verdict.output.find(once);
    REQUIRE(first != std::string::npos);
    CHECK(verdict.output.find(once, first + 1) == std::string::npos);
    CHECK_THAT(text_of(folder / "out/gap.json"), Contains("\"kind\": \"tank\""));
    CHECK_THAT(text_of(folder / "out/overlay.toml"), Contains("[measurement]\n\"tank.slope\""));
    CHECK_THAT(text_of(folder / "out/report.html"), Contains("the answer is steeper"));
}

TEST_CASE("a mistake in the kind's file ends each command with one line and status 2") {
    const auto folder = scratch_path("wrong kind");
    std::filesystem::create_directories(folder / "x");
    std::ofstream(folder / "x/my.toml") << "name = \"my\"\n[column.a]\nrole = \"observable\"\nunit = \"V\"\n"
                                           "range = [0, 1]\nmean = \"b\"\n[effect.e]\n";
    std::ofstream(folder / "x/experiment.toml") << "kind = \"my.toml\"\n[[run]]\nfile = \"a.csv\"\n";
    const std::string in = "cd '" + folder.string() + "' && ";
    for (const char* what : {"new x/my.toml y", "check x", "x"}) {
        const Ran ran = run_in_shell(in + kGap + what);
        INFO(what << ": " << ran.output);
        CHECK(ran.status == 2);
        CHECK_THAT(ran.output, Contains("my.toml") && Contains("line 6") && Contains("\"b\" at character 1"));
    }
    CHECK(run_in_shell(in + kGap + "new nothing.toml y").status == 2);
    CHECK(run_in_shell(in + kGap + "selftest --kind x/my.toml").status == 2);
}
