// What a node has stated of its future (earliest output time, lookahead) holds whatever is reset, loses its
// supply, is commanded or fails, at whichever instant and in whichever state; and the trace depends neither
// on how grants are cut, nor on placement, nor on where the run was saved and loaded.

#include "scenarios/reader/read_scenario.h"
#include "tests/time_bounds/drawn_faults.h"
#include "tests/time_bounds/drawn_run.h"
#include "tests/time_bounds/scenarios.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdlib>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

std::uint64_t number_from(const char* variable, std::uint64_t fallback) {
    const char* const given = std::getenv(variable);
    return given != nullptr ? std::strtoull(given, nullptr, 10) : fallback;
}

/// A snapshot of the first instant of a fault, or of any; two threads; a process per node; in windows or not.
Way another_way(Draw& draw, const std::filesystem::path& scenario, double seconds) {
    Way way;
    way.chop = draw.one_in(2) ? 1 + draw.below(1'000'000) : 0;
    const std::vector<cosim::Time> begins = begins_of_faults(scenario);
    const cosim::Time any = cosim::from_seconds(draw.uniform(0.01, seconds));
    switch (draw.below(4)) {
    case 0:
        way.threads = 2;
        break;
    case 1:
        way.process_per_node = true;
        break;
    case 2:
        way.from = any;
        break;
    default:
        way.from = std::max<cosim::Time>(1, draw.of(begins));
    }
    way.windows = draw.one_in(2);
    return way;
}

std::string shown(const Way& way) {
    return fmt::format("chop {}, threads {}, windows {}, processes {}, from {}", way.chop, way.threads,
                       way.windows, way.process_per_node, way.from ? cosim::to_seconds(*way.from) : -1);
}

void check_seed(const char* kind, std::uint64_t seed, DrawnScenario (*draw_one)(Draw&)) {
    const Workbench bench;
    Draw draw(seed, kind);
    const DrawnScenario drawn = draw_one(draw);
    bench.file(kScript, drawn.script);
    const auto plain = bench.file("plain.toml", drawn.toml);
    const std::string faults = drawn_faults(draw, scenarios::read_scenario(plain), drawn.seconds);
    const auto scenario = bench.file("drawn.toml", drawn.toml + faults);
    const Way cut{.chop = 1 + draw.below(1'000'000)}, other = another_way(draw, scenario, drawn.seconds);
    INFO(kind << ", seed " << seed << ", " << shown(other) << "\n" << drawn.toml << faults);
    const Conducted whole = conduct(bench, scenario, drawn.seconds, "whole", {});
    CHECK_FALSE(whole.failed);
    for (const auto& [name, way] : {std::pair("cut", cut), std::pair("other", other)}) {
        const Conducted result = conduct(bench, scenario, drawn.seconds, name, way);
        INFO(name << ": " << result.why << " / whole: " << whole.why);
        CHECK_FALSE(result.failed);
        CHECK(result.trace_sha256 == whole.trace_sha256);
    }
}

/// PUCKLOOP_DRAWN_RUNS scenarios of each kind (2), by seeds from PUCKLOOP_DRAWN_FROM (1) on.
void check_drawn(const char* kind, DrawnScenario (*draw_one)(Draw&)) {
    ::setenv("PATH", (PUCKLOOP_CONTROL_FOLDER ":" + std::string(std::getenv("PATH"))).c_str(), 1);
    const std::uint64_t first = number_from("PUCKLOOP_DRAWN_FROM", 1);
    for (std::uint64_t i = 0; i < number_from("PUCKLOOP_DRAWN_RUNS", 2); ++i)
        check_seed(kind, first + i, draw_one);
}

#ifdef PUCKLOOP_TAM
constexpr bool kTams = true;
#else
constexpr bool kTams = false;
#endif

}  // namespace

#ifdef PUCKLOOP_TAM
TEST_CASE("radio modules, their medium and TAMs keep what they state of their future") {
    check_drawn("mesh", draw_mesh);
}

TEST_CASE("IRcom's medium, robots and a TAM keep what they state of their future") {
    check_drawn("ircom", draw_ircom);
}

TEST_CASE("two TAMs that are reset while frames wait: the run goes on to its end, in both placements") {
    const Workbench bench;
    const auto file = bench.file("reset.toml", R"([run]
seed = 3
[arena]
size = ["4 m", "3 m"]
[[tam]]
name = "t0"
position = ["-1 m", "-0.5 m"]
reset = ["3.5708 s", "4.1648 s", "4.9490 s", "5.2176 s"]
[[tam]]
name = "t1"
position = ["0 m", "-0.5 m"]
start = "14 ms"
reset = ["3.5545 s", "4.6162 s"]
[coordinator]
program = ["puckloop-coordinator", "--experiment", "random-task"]
start = "100 ms"
)");
    for (const char* name : {"one", "many"}) {
        Words words{file.string(), "--duration", "8"};
        if (name == std::string_view("one")) words.emplace_back("--in-process");
        const Ended ended = bench.run(name, words);
        INFO(ended.err);
        CHECK(ended.status == 0);
        CHECK(bench.report(name)["simulated_s"].get<double>() >= 8);
    }
    CHECK(bench.report("one")["trace_sha256"] == bench.report("many")["trace_sha256"]);
}
#endif

TEST_CASE("range-and-bearing boards, buses, programs and their light keep what they state of their future") {
    check_drawn("rab", draw_rab);
}

TEST_CASE("Bluetooth modules and their network keep what they state of their future") {
    check_drawn("bluetooth", draw_bluetooth);
}

TEST_CASE("CAN buses and their controllers keep what they state of their future") {
    check_drawn("can", draw_can);
}

TEST_CASE("cameras of main boards and Linux boards keep what they state of their future") {
    check_drawn("camera", draw_camera);
}

TEST_CASE("nodes of every kind beside one another keep what they state of their future") {
    check_drawn("all", [](Draw& draw) { return draw_all(draw, kTams); });
}
