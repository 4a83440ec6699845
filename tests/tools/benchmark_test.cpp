// What `puckloop bench` computes and starts, as far as it does not depend on how fast this machine is.

#include "base/error.h"
#include "base/json.h"
#include "benchmark/cases.h"
#include "benchmark/measures/process_memory.h"
#include "benchmark/measures/timed_run.h"
#include "benchmark/scenarios/lab_scenario.h"
#include "benchmark/scenarios/wander_scenario.h"
#include "benchmark/speeds/board_replay.h"
#include "benchmark/speeds/work_profile.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/kit/scratch.h"
#include "tests/tools/shell.h"

#include <catch2/catch.hpp>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace puckloop;
using namespace puckloop::tools;
using Catch::Contains;
using tests::run_puckloop;

namespace {

/// A folder that goes with the test.
class Scratch {
  public:
    Scratch() { std::filesystem::create_directories(path_); }
    ~Scratch() { std::filesystem::remove_all(path_); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_ = tests::scratch_path("puckloop_benchmark_test");
};

const std::filesystem::path kHello = PUCKLOOP_SOURCE "/scenarios/hello.toml";
const std::filesystem::path kPair = PUCKLOOP_SOURCE "/scenarios/rab_pair.toml";
const std::filesystem::path kMainImage = PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex";
const std::filesystem::path kRabImage = PUCKLOOP_SOURCE "/firmware/rab/rab.hex";

}  // namespace

TEST_CASE("figures have medians, and ratios round by round") {
    // The machine was twice as slow in the second round: the ratio does not see it.
    CHECK(median_ratio({8, 4, 8}, {4, 2, 4}) == 2);
    CHECK(median_ratio({8}, {}) == 0);

    const std::vector<Figure> figures{
        {"walk", "x real time", {8, 4, 9}, {4, 2, 4.5}, {16, 8, 18}, "as expected"},
        {"nothing", "s", {}, {}, {}}};
    const OtherLoad load{2, 0.5, 1, 3};
    const auto json = nlohmann::json::parse(figures_json(figures, load));
    REQUIRE(json["figures"].size() == 1);
    const auto& walk = json["figures"][0];
    CHECK(walk["median"] == 8);
    CHECK(walk["lowest"] == 4);
    CHECK(walk["highest"] == 9);
    CHECK(walk["ratio_to_reference"] == 2);
    CHECK(walk["peer_median"] == 16);
    CHECK(walk["ratio_to_peer"] == 0.5);
    CHECK(walk["note"] == "as expected");
    CHECK(json["other_load"]["busy_with_other_work"] == 0.5);
    CHECK_THAT(figures_table(figures, load),
               Contains("walk: as expected") && Contains("0.50 of 2 processors"));

    CHECK(median_in(figures_json(figures, load), "walk") == 8);
    CHECK(median_in(R"([{"name": "walk", "median": 7.5}])", "walk") == 7.5);
    CHECK_THROWS_AS(median_in("[]", "walk"), RunError);
    CHECK_THROWS_AS(median_in("puckloop: no such case", "walk"), RunError);
}

TEST_CASE("what other programs take of the processors is read from the kernel's counters") {
    // user nice system idle iowait irq softirq steal guest guest_nice
    CHECK(busy_seconds("cpu  100 20 30 4000 500 6 7 8 90 9", 100) == Approx(1.71));
    CHECK(busy_seconds("intr 5", 100) == 0);
    CHECK(busy_seconds("", 100) == 0);
    const OtherLoad load = OtherLoadMeter().read();
    CHECK(load.busy >= 0);
    CHECK(load.busy <= load.processors);
}

TEST_CASE("wandering robots have the same room each, however many") {
    const Scratch scratch;
    for (const int robots : {1, 2, 10, 100}) {
        const auto scenario =
            scenarios::read_scenario(write_wander_scenario(scratch.path(), robots, kMainImage));
        const auto& bodies = scenario.world.robots;
        REQUIRE(bodies.size() == static_cast<std::size_t>(robots));
        REQUIRE(scenario.robots.size() == bodies.size());
        double nearest = 9;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            for (std::size_t k = 0; k < i; ++k)
                nearest = std::min(nearest, std::hypot(bodies[i].x - bodies[k].x, bodies[i].y - bodies[k].y));
        if (robots > 1) CHECK(nearest == Approx(0.3));
    }
}

TEST_CASE("robots of a laboratory have the floor of twenty in a dodecagon") {
    const Scratch scratch;
    for (const int robots : {2, 20, 50}) {
        const auto scenario = scenarios::read_scenario(
            write_lab_scenario(scratch.path(), {robots, kMainImage, kRabImage, {}, 0.1}));
        REQUIRE(scenario.world.robots.size() == static_cast<std::size_t>(robots));
        double outermost = 0;
        for (const auto& body : scenario.world.robots)
            outermost = std::max(outermost, std::hypot(body.x, body.y));
        CHECK(outermost < 1.231 * std::sqrt(robots / 20.0) - 0.04);  // a robot's radius is 3.7 cm
        for (const auto& robot : scenario.robots)
            CHECK(robot.rab.has_value());
    }
}

TEST_CASE("work is counted by cause, and nothing of a run in one process is done twice") {
    const Scratch scratch;
    ::setenv("PATH", (PUCKLOOP_CONTROL_FOLDER ":" + std::string(std::getenv("PATH"))).c_str(), 1);
    RunRequest request;
    request.scenario = write_lab_scenario(scratch.path(), {2, kMainImage, kRabImage, {}, 0.1});
    request.out = scratch.path() / "profiled";
    request.duration = 0.4;
    request.in_process = true;
    request.threads = 1;
    const WorkProfile profile = profile_work(request);
    const double simulated_us = 1e6 * profile.simulated_s;
    CHECK(profile.simulated_s >= 0.4);
    CHECK(profile.messages.at("ir") > 100);
    for (const char* kind : {"pic", "rab"}) {
        const KindWork* work = profile.kind(kind);
        REQUIRE(work != nullptr);
        INFO(kind);
        CHECK(work->nodes == 2);
        CHECK(work->count("grants") > 10);
        CHECK(work->count("us executed") == 2 * std::floor(simulated_us));
        CHECK(work->count("instructions executed") > 100'000);
        CHECK(work->count("instructions in all") == work->count("instructions executed") +
                                                        work->count("instructions passed in loops") +
                                                        work->count("instructions passed in routines"));
        for (const char* again : {"marks", "rewinds", "bytes copied for going back"})
            CHECK(work->count(again) == 0);
    }
    REQUIRE(profile.kind("world") != nullptr);
    CHECK(profile.kind("world")->count("us executed") == std::floor(simulated_us));
    double executed = 0;
    for (const char* kind : {"pic", "rab"})
        executed += profile.kind(kind)->count("instructions executed");
    CHECK(profile.instructions_needed() > 0);
    CHECK(profile.instructions_needed() <= executed);
}

TEST_CASE("boards alone execute what they did in the run") {
    const Scratch scratch;
    // The test program is not built where puckloop looks for its control program.
    ::setenv("PATH", (PUCKLOOP_CONTROL_FOLDER ":" + std::string(std::getenv("PATH"))).c_str(), 1);
    // Half a second of every board, with programs that talk to the second scenario's boards from 0.2 s on.
    for (const auto& [scenario, seconds] : {std::pair{kHello, 1.2}, std::pair{kPair, 0.5}}) {
        Recording recording = record_boards(scenario, seconds, scratch.path());
        CHECK(recording.boards.size() == (scenario == kHello ? 1 : 4));
        const ReplayTiming first = replay_boards(recording), second = replay_boards(recording);
        CHECK(first.wall_s > 0);
        CHECK(first.instructions > 1'000'000);
        CHECK(first.instructions == second.instructions);
        CHECK(first.cycles == second.cycles);

        // An answer that is another one, or missing, is noticed.
        auto& sent = recording.boards.back().life.sent;
        REQUIRE(sent.size() > 10);
        const cosim::Message last = sent.back();
        sent.back().time -= 1;
        CHECK_THROWS_WITH(replay_boards(recording), Contains(recording.boards.back().life.board.node));
        sent.pop_back();
        CHECK_THROWS_AS(replay_boards(recording), RunError);
        sent.push_back(last);
        CHECK_NOTHROW(replay_boards(recording));
    }
}

TEST_CASE("a program is timed from outside, and its failure is its own words") {
    const ProgramTiming timing = time_program({"/bin/sh", "-c", "echo here; echo there >&2"});
    CHECK(timing.output == "here\n");
    CHECK(timing.wall_s > 0);
    CHECK_THROWS_WITH(time_program({"/bin/sh", "-c", "echo first >&2; echo why >&2; exit 3"}),
                      Contains("why"));
    CHECK_THROWS_WITH(time_program({"/no/such/program"}), Contains("No such file"));
    CHECK_THROWS_AS(time_program({"/bin/sh", "-c", "kill -9 $$"}), RunError);
}

TEST_CASE("memory counts what a program started") {
    // `tail` keeps all it reads until there is an end.
    double most = 0;
    std::size_t processes = 0;
    time_program({"/bin/sh", "-c", "{ head -c 60000000 /dev/zero; sleep 0.5; } | tail -c 60000000 | wc -c"},
                 [&](pid_t root) {
                     most = std::max(most, resident_mbytes(root));
                     processes = std::max(processes, process_tree(root).size());
                 });
    CHECK(most > 55);
    CHECK(most < 90);
    CHECK(processes >= 4);
    CHECK(resident_mbytes(::getpid()) > 1);
}

TEST_CASE("a run is timed by its own report, and a build may be its own peer") {
    const Scratch scratch;
    const RunTiming timing = time_run(PUCKLOOP_PROGRAM, {kHello, 1.1, true, 1}, scratch.path() / "o");
    CHECK(timing.simulated_s >= 1.1);
    CHECK(timing.wall_s > 0);
    CHECK(timing.wall_s <= timing.program.wall_s);
    CHECK(timing.trace_sha256.size() == 64);
    CHECK_THROWS_WITH(
        time_run(PUCKLOOP_PROGRAM, {scratch.path() / "none.toml", 1, true, 1}, scratch.path() / "o"),
        Contains("none.toml"));

    std::vector<std::string> names;
    for (const char* words : {"bench --json --rounds 1 --duration 1.1 --case overhead",
                              "bench --json --rounds 2 --duration 1.1 --case wait --peer " PUCKLOOP_PROGRAM,
                              "bench --json --rounds 2 --duration 1.1 --case wander --case memory --robots 1 "
                              "--robots 2 --peer " PUCKLOOP_PROGRAM}) {
        const auto bench = run_puckloop(words);
        INFO(bench.output);
        REQUIRE(bench.status == 0);
        const bool peer = std::string(words).find("--peer") != std::string::npos;
        const auto json = nlohmann::json::parse(bench.output);
        for (const auto& figure : json["figures"]) {
            names.push_back(figure["name"]);
            INFO(names.back());
            CHECK(figure["values"].size() == (peer ? 2 : 1));
            // Between one robot and two, in a fifth of a second, memory is as the samples happen to fall.
            if (!names.back().starts_with("memory a robot")) CHECK(figure["median"] > 0);
            CHECK_FALSE(figure.contains("note"));  // such as another trace
            if (figure["unit"] == "x real time") CHECK(figure.contains("ratio_to_peer") == peer);
        }
    }
    for (const char* name :
         {"hello.toml, overhead factor", "swarm.toml, 1 thread, overhead factor", "hello.toml, boards alone",
          "epuck.hex, 42.1 s from power-up", "wander, 2 robots", "peak memory, 2 wandering"})
        CHECK(std::find(names.begin(), names.end(), name) != names.end());
}

TEST_CASE("a peer that is none is refused, one that cannot do a case is noted") {
    const auto none = run_puckloop("bench --peer /no/such/build --rounds 1");
    CHECK(none.status == 2);
    CHECK_THAT(none.output, Contains("/no/such/build") && Contains("--peer"));
    const auto stranger =
        run_puckloop("bench --json --case wander --robots 1 --rounds 2 --duration 1 --peer /bin/false");
    INFO(stranger.output);
    REQUIRE(stranger.status == 0);
    const auto json = nlohmann::json::parse(stranger.output);
    const auto& figure = json["figures"][0];
    CHECK_THAT(figure["note"].get<std::string>(), Contains("not run by the peer"));
    CHECK_FALSE(figure.contains("ratio_to_peer"));
}
