// Robots find TAMs from wherever they start: scenarios/tam.toml with places drawn at random, and with the
// unmodified firmware of robots and TAMs.
//
// Drawn are places anywhere in the arena 10 cm from its walls, 16 cm from the booths' middles and 12 cm from
// each other, and any headings. PUCKLOOP_POSES is the number of such runs (1), PUCKLOOP_POSES_SEED that of
// the draws (1).

#include "base/random.h"
#include "tests/end_to_end/tam/tam_visits.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

const std::string kScenario = PUCKLOOP_SOURCE "/scenarios/tam.toml";
constexpr int kRobots = 2;
constexpr int kGreenWord = 0x11, kBlueWord = 0x22;  // the coordinator's

struct Pose {
    double x = 0, y = 0, heading = 0;  // cm, degrees
};

std::vector<Pose> draw(RandomStream& random) {
    std::vector<Pose> poses;
    while (poses.size() < kRobots) {
        const Pose pose{100 * random.uniform() - 50, 70 * random.uniform() - 35,
                        360 * random.uniform() - 180};
        const bool clear = std::hypot(std::abs(pose.x) - 30, pose.y - 30) > 16 &&
                           std::all_of(poses.begin(), poses.end(), [&](const Pose& other) {
                               return std::hypot(pose.x - other.x, pose.y - other.y) > 12;
                           });
        if (clear) poses.push_back(pose);
    }
    return poses;
}

void replace(std::string& text, const std::string& what, const std::string& with) {
    REQUIRE(text.find(what) != std::string::npos);
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
        text.replace(at, what.size(), with);
}

/// The shipped scenario, to be run from anywhere, with the robots elsewhere.
std::string scenario_with(const std::vector<Pose>& poses) {
    std::string text = text_of(kScenario);
    replace(text, "\"../firmware/", "\"" PUCKLOOP_SOURCE "/firmware/");
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::size_t begin = text.find(fmt::format("name = \"robot{}\"\n", i));
        const std::size_t end = text.find("[robot.pic]", begin);
        REQUIRE(end != std::string::npos);
        text.replace(
            begin, end - begin,
            fmt::format(
                "name = \"robot{}\"\nposition = [\"{:.1f} cm\", \"{:.1f} cm\"]\nheading = \"{:.1f} deg\"\n\n",
                i, poses[i].x, poses[i].y, poses[i].heading));
    }
    return text;
}

int number_from(const char* variable, int fallback) {
    const char* const asked = std::getenv(variable);
    return asked ? std::atoi(asked) : fallback;
}

bool heard_its_task(const RobotVisits& visits) {
    return visits.heard.contains(kGreenWord) || visits.heard.contains(kBlueWord);
}

bool reported(const Workbench& bench, const std::string& run, const std::string& word) {
    for (const auto& [tam, words] : values_of(bench, run, "heard"))
        if (std::find(words.begin(), words.end(), word) != words.end()) return true;
    return false;
}

}  // namespace

TEST_CASE("robots find a booth by its colour, talk in it and come out, from wherever they start") {
    const int runs = number_from("PUCKLOOP_POSES", 1);
    RandomStream random(static_cast<std::uint64_t>(number_from("PUCKLOOP_POSES_SEED", 1)), "poses");
    int found = 0, talked = 0, tasks = 0, aborted = 0;
    std::vector<double> times;
    std::string each;
    for (int run = 0; run < runs; ++run) {
        const std::vector<Pose> poses = draw(random);
        const Workbench bench;
        const auto file = bench.file("drawn.toml", scenario_with(poses));
        const Ended ended =
            bench.run("o", {file, "--duration", "100", "--in-process", "--threads", "1", "--no-cache"});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const auto visits = visits_of(bench, "o", kRobots);
        for (std::size_t i = 0; i < visits.size(); ++i) {
            const bool inside = !visits[i].entered.empty();
            const bool both_ways = heard_its_task(visits[i]) && reported(bench, "o", fmt::format("a{}", i));
            found += inside;
            talked += both_ways;
            if (inside) times.push_back(visits[i].entered.front());
            each += fmt::format("run {} robot{} from ({:.1f}, {:.1f}) cm, {:.1f} deg: {}, {}\n", run, i,
                                poses[i].x, poses[i].y, poses[i].heading,
                                inside ? fmt::format("inside after {:.1f} s", visits[i].entered.front())
                                       : "never inside",
                                both_ways ? "words both ways" : "no words both ways");
        }
        for (const auto& [tam, values] : values_of(bench, "o", "task")) {
            tasks += static_cast<int>(std::count(values.begin(), values.end(), "done"));
            aborted += static_cast<int>(std::count(values.begin(), values.end(), "aborted"));
        }
        CHECK(bench.report("o")["warnings"].empty());
    }
    std::sort(times.begin(), times.end());
    const double median = times.empty() ? 0 : times[times.size() / 2];
    const std::string summary = fmt::format(
        "{} robots: {} inside within 100 s (median {:.1f} s, last {:.1f} s), {} with words both ways; "
        "{} tasks done, {} aborted",
        kRobots * runs, found, median, times.empty() ? 0 : times.back(), talked, tasks, aborted);
    WARN(each << summary);
    // Two robots for two booths: one that meets the other at each of them may need longer, one in twenty.
    CHECK(found >= kRobots * runs - runs / 10);
    CHECK(talked >= kRobots * runs - runs / 10);
    CHECK(tasks >= 2 * runs);
    CHECK(aborted <= runs / 5);
}

TEST_CASE("the unmodified firmware of robots and TAMs does the whole of it", "[slow]") {
    const auto robot = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    const auto tam = outside("PUCKLOOP_IMAGES", "tam_firmware.elf");
    if (!robot || !tam) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with epuck_firmware.hex and tam_firmware.elf");
        return;
    }
    RandomStream random(static_cast<std::uint64_t>(number_from("PUCKLOOP_POSES_SEED", 1)), "real poses");
    const Workbench bench;
    const std::vector<Pose> poses = draw(random);
    std::string text = scenario_with(poses);
    replace(text, PUCKLOOP_SOURCE "/firmware/epuck/epuck_ircom.hex", robot->string());
    // Its boot takes 41 s; it hears only for 83 ms behind each word of its own.
    replace(text, "start = \"1 s\"", "start = \"42 s\"");
    replace(text, "start = \"1.2 s\"", "start = \"42.2 s\"");
    replace(text, "\"--ircom-every\", \"0.7\"", "\"--ircom-every\", \"0.3\"");
    for (const char* name : {"tam0", "tam1"})
        replace(text, fmt::format("name = \"{}\"\n", name),
                fmt::format("name = \"{}\"\nfirmware = \"{}\"\n", name, tam->string()));
    const auto file = bench.file("real.toml", text);
    const Ended ended = bench.run("o", {file, "--duration", "140", "--in-process", "--threads", "1"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto visits = visits_of(bench, "o", kRobots);
    for (std::size_t i = 0; i < visits.size(); ++i) {
        CAPTURE(i, poses[i].x, poses[i].y, poses[i].heading);
        CHECK_FALSE(visits[i].entered.empty());
        CHECK(visits[i].left);
        CHECK(heard_its_task(visits[i]));
        CHECK(reported(bench, "o", fmt::format("a{}", i)));
    }
    const auto nodes = bench.report("o")["nodes"];
    for (const char* board : {"tam0.avr", "tam1.avr"}) {
        CHECK(nodes[board]["unmodelled"].empty());
        // A beam for each way: in and out.
        CHECK(nodes[board]["interruptions"]["front"].get<int>() +
                  nodes[board]["interruptions"]["back"].get<int>() >=
              2);
    }
    int done = 0;
    for (const auto& [name, values] : values_of(bench, "o", "task"))
        done += static_cast<int>(std::count(values.begin(), values.end(), "done"));
    CHECK(done >= 2);
}
