// The real firmware of the robot, unmodified, commanded by the project's own control program
// (PUCKLOOP_IMAGES) and by ARGoS's real-robot program (PUCKLOOP_ARGOS: a folder with argos_epuck and
// avoid.argos). PUCKLOOP_REPEATS sets how often the latter is repeated (2).

#include "tests/end_to_end/kit/load.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace puckloop::tests;

namespace {

const std::string kScenario = PUCKLOOP_SOURCE "/scenarios/own_binaries.toml";
// The serial session: a byte to wake the PIC, four of configuration, then frames of twelve.
constexpr std::size_t kHandshake = 5, kFrame = 12, kCommand = 10;
constexpr std::size_t kRecord = 72;

struct Frames {
    int normal = 0, reset = 0, others = 0;
    std::size_t rest = 0;  ///< bytes that fill no frame
};

Frames frames_of(const std::vector<int>& bytes) {
    Frames frames;
    std::size_t at = kHandshake;
    for (; at + kFrame <= bytes.size(); at += kFrame) {
        const int command = bytes[at + kCommand];
        (command == 'N' ? frames.normal : command == 'R' ? frames.reset : frames.others) += 1;
    }
    frames.rest = bytes.size() > at ? bytes.size() - at : 0;
    return frames;
}

int repeats() {
    const char* text = std::getenv("PUCKLOOP_REPEATS");
    return text ? std::max(1, std::atoi(text)) : 2;
}

void check_session(const Workbench& bench, const std::string& name) {
    INFO(name);
    const auto trace = bench.csv(name, "trace.csv");
    const auto sent = bytes_sent(trace, "robot0.uart", "robot0.linux");
    const Frames frames = frames_of(sent);
    CHECK(frames.normal == 600);
    CHECK(frames.reset == 1);
    CHECK(frames.others == 0);
    CHECK(frames.rest == 0);
    CHECK(bytes_sent(trace, "robot0.uart", "robot0.pic").size() == 601 * kRecord);
    const Journey path = journey(bench.csv(name, "trajectory.csv"));
    CHECK(path.length > 1.0);
    CHECK(path.clearance > 0.0);
    CHECK(bench.report(name)["warnings"].empty());
}

}  // namespace

TEST_CASE("the original firmware works with the project's own control program") {
    const auto image = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    if (!image) {
        WARN("PUCKLOOP_IMAGES has no epuck_firmware.hex: skipped");
        return;
    }
    const Workbench bench;
    const Words words{kScenario, "--firmware", "robot0.pic=" + image->string(), "--duration", "52"};
    Words in_one = words;
    in_one.push_back("--in-process");
    REQUIRE(bench.run("many", words).status == 0);
    REQUIRE(bench.run("one", in_one).status == 0);
    check_same_run(bench, "one", "many");
    const auto trace = bench.csv("one", "trace.csv");
    const Frames frames = frames_of(bytes_sent(trace, "robot0.uart", "robot0.linux"));
    // A frame each 100 ms from just after 42 s to 52 s; then, asked to end, one that stops the wheels, and
    // 'R'.
    CHECK(frames.normal >= 98);
    CHECK(frames.normal <= 101);
    CHECK(frames.reset == 1);
    CHECK(frames.rest == 0);
    CHECK(frames.others == 0);
    const Journey path = journey(bench.csv("one", "trajectory.csv"));
    CHECK(path.length > 0.1);
    CHECK(path.clearance > 0.0);
    CHECK(bench.report("one")["nodes"]["robot0.pic"]["uart2"]["framing_errors"] == 0);
}

TEST_CASE("ARGoS's real-robot program runs a minute on the original firmware", "[argos]") {
    const auto image = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    const auto program = outside("PUCKLOOP_ARGOS", "argos_epuck");
    const auto experiment = outside("PUCKLOOP_ARGOS", "avoid.argos");
    if (!image || !program || !experiment) {
        WARN("PUCKLOOP_IMAGES has no epuck_firmware.hex, or PUCKLOOP_ARGOS no argos_epuck and avoid.argos: "
             "skipped");
        return;
    }
    const Workbench bench;
    const auto run = [&](const std::string& name, bool in_process) {
        Words words{kScenario, "--firmware", "robot0.pic=" + image->string()};
        if (in_process) words.push_back("--in-process");
        words.insert(words.end(), {"--linux", *program, "-c", *experiment, "-i", "avoid"});
        words.insert(words.begin(), {"run", "--out", bench.out(name)});
        const Ended ended = bench.start(words)->wait(600);
        INFO(name << ": " << ended.err);
        REQUIRE(ended.status == 0);
    };
    run("first", true);
    check_session(bench, "first");
    for (int i = 1; i <= repeats(); ++i) {
        for (const bool in_process : {true, false}) {
            run("next", in_process);
            check_same_run(bench, "first", "next");
        }
    }
    const Load load(3);
    run("busy", false);
    check_same_run(bench, "first", "busy");
}
