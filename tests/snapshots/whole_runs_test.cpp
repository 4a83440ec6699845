// Runs of boards, Linux programs and the world, saved at drawn instants: whoever goes on is the whole run.

#include "base/random.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

const std::string kSecondRobot = R"(
[robot.rab]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/rab/rab.hex"

[[robot]]
name = "robot1"
position = ["10 cm", "-5 cm"]
heading = "100 deg"

[robot.pic]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/epuck/epuck.hex"

[robot.rab]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/rab/rab.hex"

[robot.linux]
program = ["puckloop-control", "--behaviour", "wander", "--duration", "55"]
start = "700 ms"

[[event]]
at = "900 ms"
add = "cylinder"
name = "can"
centre = ["25 cm", "-20 cm"]
radius = "3 cm"
)";

/// Everything that a run left, but for logs of boards and what differs with the wall clock.
void check_same_files(const Workbench& bench, const std::string& a, const std::string& b) {
    check_same_run(bench, a, b);
    for (const auto& entry : fs::directory_iterator(bench.out(a))) {
        const std::string name = entry.path().filename();
        if (name == "report.json" || !entry.is_regular_file()) continue;
        INFO(name);
        const bool same = text_of(entry.path()) == text_of(bench.out(b) / name);
        CHECK(same);
    }
    auto left = bench.report(a), right = bench.report(b);
    for (const char* log : {"robot0.linux", "robot1.linux"})
        for (auto* report : {&left, &right})
            if ((*report)["nodes"].contains(log)) (*report)["nodes"][log].erase("log");
    for (auto* report : {&left, &right}) {
        for (const char* key : {"wall_s", "real_time_factor", "grants", "from", "command_line"})
            report->erase(key);
        for (auto& node : (*report)["nodes"])
            for (const char* key : {"grants", "requests", "answered_by_library"})
                node.erase(key);
    }
    CHECK(left == right);
}

}  // namespace

TEST_CASE("a whole run goes on from drawn instants, in every placement") {
    const std::uint64_t seed = Catch::rngSeed();
    INFO("seed " << seed);
    puckloop::RandomStream random(seed, "instants");
    const Workbench bench;
    const fs::path scenario = bench.hello(kSecondRobot);
    const Words faults{"--fault", "flip link=robot0.uart p=0.02 may_not_fire=true", "--fault",
                       "nack link=robot0.i2c p=0.05 may_not_fire=true"};
    Words whole{scenario, "--duration", "2.5", "--in-process"};
    whole.insert(whole.end(), faults.begin(), faults.end());
    REQUIRE(bench.run("whole", whole).status == 0);
    Words saving = whole;
    std::vector<std::string> times;
    for (int i = 0; i < 3; ++i) {
        times.push_back(fmt::format("{:.9g}", 0.05 + 0.8 * i + 0.8 * random.uniform()));
        saving.insert(saving.end(), {"--save-at", times.back()});
    }
    saving.insert(saving.end(), {"--save", bench.folder() / "run.snap"});
    const Ended saved = bench.run("saving", saving);
    INFO(saved.err);
    REQUIRE(saved.status == 0);
    CHECK_THAT(saved.out, Catch::Contains("snapshot of "));
    check_same_files(bench, "whole", "saving");
    for (std::size_t i = 0; i < times.size(); ++i) {
        INFO("from " << times[i]);
        const fs::path file = bench.folder() / fmt::format("run-{}s.snap", std::stod(times[i]));
        Words on{"--from", file};
        if (i != 1) on.insert(on.end(), {"--in-process", "--threads", i == 0 ? "2" : "1"});
        const Ended ended = bench.run("on", on);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        CHECK_THAT(ended.out, Catch::Contains("went on from "));
        check_same_files(bench, "whole", "on");
    }
}

TEST_CASE("faults that begin later do what they do in a whole run") {
    const Workbench bench;
    const fs::path scenario = bench.hello();
    const fs::path file = bench.folder() / "run.snap";
    REQUIRE(
        bench.run("saving", {scenario, "--duration", "2", "--in-process", "--save-at", "1.6", "--save", file})
            .status == 0);
    const Words more{"--duration",
                     "3",
                     "--in-process",
                     "--fault",
                     "drop link=robot0.uart from=robot0.pic begin=\"1.7 s\" skip=5 count=1",
                     "--fault",
                     "flip node=robot0.pic begin=\"1.8 s\" space=ram address=0x1100 bit=3",
                     "--fault",
                     "restart node=robot0.linux begin=\"2 s\""};
    Words whole{scenario}, on{"--from", file};
    whole.insert(whole.end(), more.begin(), more.end());
    on.insert(on.end(), more.begin(), more.end());
    REQUIRE(bench.run("whole", whole).status == 0);
    const Ended ended = bench.run("on", on);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    check_same_files(bench, "whole", "on");
}
