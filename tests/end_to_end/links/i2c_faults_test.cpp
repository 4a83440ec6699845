// What the project's own driver (puckloop-control) and board firmware make of every I2C fault, with places
// and times drawn at random: they go on by themselves within a stated time, and the robot never stops
// listening to its PIC meanwhile.

#include "base/random.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <regex>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// A robot that wanders, sends and asks its board for messages fifty times a second each.
std::string scenario() {
    const std::string firmware = PUCKLOOP_SOURCE "/firmware/";
    return "[run]\nduration = \"3.6 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n[[robot]]\nname = \"robot0\"\n"
           "position = [\"0 cm\", \"0 cm\"]\nheading = \"30 deg\"\n"
           "[robot.pic]\nfirmware = \"" +
           firmware + "epuck/epuck.hex\"\n[robot.rab]\nfirmware = \"" + firmware +
           "rab/rab.hex\"\n[robot.linux]\nprogram = [\"puckloop-control\", \"--behaviour\", \"wander\", "
           "\"--rab\", \"--rab-id\", \"1\", \"--duration\", \"10\"]\nstart = \"100 ms\"\n";
}

struct Polls {
    int before = 0, during = 0, after = 0;  ///< bytes read from the board by Linux
    double longest_gap = 0;                 ///< s, from the end of the fault on
};

Polls polls(const Workbench& bench, const std::string& name, double begin, double end, double recovered) {
    Polls polls;
    double last = recovered;
    for (const Row& row : bench.csv(name, "trace.csv")) {
        if (row.at("link") != "robot0.i2c.linux" || row.at("detail") != "data") continue;
        const double time = std::stod(row.at("time_s"));
        ++(time < begin ? polls.before : time < end ? polls.during : polls.after);
        if (time < recovered) continue;
        polls.longest_gap = std::max(polls.longest_gap, time - last);
        last = time;
    }
    return polls;
}

/// Longest time in which Linux sent the PIC nothing, once it had begun.
double longest_silence(const Workbench& bench, const std::string& name) {
    double last = 0, longest = 0;
    for (const Row& row : bench.csv(name, "trace.csv")) {
        if (row.at("link") != "robot0.uart" || row.at("from") != "robot0.linux") continue;
        const double time = std::stod(row.at("time_s"));
        if (last > 0.5) longest = std::max(longest, time - last);
        last = time;
    }
    return longest;
}

}  // namespace

TEST_CASE("every I2C fault: the own driver and firmware go on within their bound") {
    // A board that failed five operations is asked again a second later, and set up in 45 ms.
    constexpr double kAskedAgain = 1.2;
    // What one message of an operation, tried four times, can keep the control loop at most; a bus that hangs
    // keeps it as long as it hangs, since a message has i2c-omap's second.
    constexpr double kControlPeriod = 0.1;
    struct Case {
        std::string words;    ///< the fault, without its time
        double lasts = 0;     ///< s, beyond its time
        double bound = 0.25;  ///< s: a poll succeeds so soon after it
    };
    puckloop::RandomStream random(20, "i2c faults");
    const auto below = [&random](int n) {
        return static_cast<int>(random.below(static_cast<std::uint64_t>(n)));
    };
    const std::vector<Case> cases{
        {"nack address=0x20 phase=address"},
        {fmt::format("nack address=0x20 phase=write position={}", 1 + below(2))},
        {"nack address=0x20 probability=0.3 for=500ms", 0.5},
        {"nack address=0x20 for=400ms", 0.4, kAskedAgain},
        {fmt::format("flip address=0x20 phase=read bit={}", below(8))},
        {fmt::format("flip address=0x20 phase=address bit={}", 1 + below(7))},
        {"flip address=0x20 probability=0.05 for=500ms", 0.5},
        {fmt::format("stretch address=0x20 position={} time={}us", below(2), 500 + below(5000))},
        {"sda time=200ms", 0.2, kAskedAgain},
        {"scl time=600ms", 0.6, kAskedAgain},
        {fmt::format("lose_arbitration phase={} time={}us", below(2) == 0 ? "address" : "write",
                     100 + below(5000))},
        {fmt::format("stop position={}", 1 + below(2))},
        {fmt::format("start position={}", 1 + below(2))},
        {"incomplete_address_phase address=0x20"},
        {"incomplete_write_byte address=0x20"},
        {"slave_reset address=0x20 time=20ms", 0.02},
        {fmt::format("clash address=0x20 value={} for=300ms", below(256)), 0.3},
        {fmt::format("slow_rise time={}us for=300ms", 1 + below(20)), 0.3},
    };
    const Workbench bench;
    const auto file = bench.file("faults.toml", scenario());
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Case& one = cases[i];
        const double begin = 1.0 + 0.001 * below(300);
        const std::string name = fmt::format("run{}", i);
        const bool lasting = one.words.find("for=") != std::string::npos;
        const std::string words =
            fmt::format("{} link=robot0.i2c {}={}ms", one.words, lasting ? "begin" : "at", begin * 1e3);
        INFO(words);
        const Ended ended = bench.run(name, {file, "--in-process", "--fault", words});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const auto report = bench.report(name);
        CHECK(report["faults"][0]["fired"] > 0);
        CHECK(report["faults"][0]["firings"].size() > 0);
        const double end = begin + one.lasts;
        const Polls seen = polls(bench, name, begin, end, end + one.bound);
        CHECK(seen.before > 20);
        CHECK(seen.after > 40);
        CHECK(seen.longest_gap < 0.15);  // polled every 20 ms
        const double hangs = one.words.starts_with("scl ") || one.words.starts_with("sda ") ? one.lasts : 0.0;
        CHECK(longest_silence(bench, name) < 3 * kControlPeriod + hangs);
    }
}

TEST_CASE("I2C and Linux faults: the same trace and evidence in every placement") {
    const Workbench bench;
    const auto file = bench.file("faults.toml", scenario());
    Words words{file, "--duration", "2"};
    for (const char* const fault :
         {"nack link=robot0.i2c address=0x20 probability=0.1",
          "flip link=robot0.i2c phase=read probability=0.1",
          "stretch link=robot0.i2c time=300us probability=0.2", "sda link=robot0.i2c at=1s time=70ms",
          "lose_arbitration link=robot0.i2c probability=0.02 time=1ms",
          "incomplete_write_byte link=robot0.i2c address=0x20 at=1300ms",
          "short_read node=robot0.linux most=3 every=2", "read_error node=robot0.linux errno=EAGAIN every=7",
          "pause node=robot0.linux at=1500ms time=80ms",
          "starve node=robot0.linux factor=20 begin=1600ms end=1800ms"}) {
        words.push_back("--fault");
        words.push_back(fault);
    }
    std::string sha, faults;
    for (const Words& more : {Words{"--in-process"}, Words{}, Words{"--in-process", "--threads", "2"}}) {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        const std::string name = fmt::format("run{}", more.size());
        const Ended ended = bench.run(name, all);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const auto report = bench.report(name);
        for (const auto& fault : report["faults"])
            CHECK(fault["fired"] > 0);
        if (sha.empty()) {
            sha = report["trace_sha256"];
            faults = report["faults"].dump();
        }
        CHECK(report["trace_sha256"] == sha);
        CHECK(report["faults"].dump() == faults);
    }
}

TEST_CASE("bad I2C and Linux faults are refused in one line") {
    const Workbench bench;
    const auto file = bench.file("faults.toml", scenario());
    const auto refused = [&](const std::string& fault, const std::string& word) {
        const Ended ended = bench.run("bad", {file, "--fault", fault});
        INFO(ended.err);
        CHECK(ended.status == 2);
        CHECK_THAT(ended.err, Contains(word));
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
    };
    refused("nack link=robot9.i2c", "robot9.i2c");
    refused("nack link=robot0.uart", "nack");
    refused("stretch link=robot0.i2c", "time");
    refused("nack link=robot0.i2c address=0x80", "address");
    refused("flip link=robot0.i2c bit=8", "bit");
    refused("clash link=robot0.i2c", "address");
    refused("stop link=robot0.i2c position=0", "START");
    refused("read_error node=robot0.linux errno=EMAGIC", "errno");
    refused("pause node=robot0.linux at=1s", "time");
    const auto endless = bench.file("endless.toml", [] {
        std::string text = scenario();
        return text.erase(0, text.find("[arena]"));
    }());
    const Ended ended = bench.run("bad", {endless, "--fault", "kill node=robot0.linux at=1s run=goes_on"});
    CHECK(ended.status == 2);
    CHECK_THAT(ended.err, Contains("nothing ends this run"));
    refused("pause node=robot0.pic at=1s time=1s", "robot0.pic");
}
