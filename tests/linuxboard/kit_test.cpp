// The rarer ways to wait, and what else a program may do with its devices.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <fstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;

namespace {
std::string run_alike(const linuxboard::LinuxSpec& spec, const std::function<void(Bench&)>& prepare) {
    std::string first;
    // Twice, with grants cut differently: the same to the byte.
    for (const Time slice : {70 * kMicrosecond, 17 * kMicrosecond}) {
        Bench bench(spec, slice);
        if (prepare) prepare(bench);
        bench.run(kSecond);
        INFO(bench.log());
        REQUIRE(bench.node().stop());
        INFO(bench.node().stop()->reason);
        CHECK(bench.node().stop()->success);
        if (first.empty()) first = bench.log() + bench.trace();
        CHECK(bench.log() + bench.trace() == first);
    }
    return first;
}

std::string run_kit(const std::string& what, const std::function<void(Bench&)>& prepare = {}) {
    return run_alike(spec_for("kit", {what}), prepare);
}
}  // namespace

TEST_CASE("alarms, interval timers and timerfd run in simulated time") {
    CHECK_THAT(run_kit("timers"),
               Contains("alarms 3 at 21\nticks 1 at 31\nticks 2 at 56\npoll 1 0 1 at 61\n"));
}

TEST_CASE("epoll watches devices and other descriptors together") {
    const std::string text = run_kit("epoll", [](Bench& bench) { bench.send(40 * kMillisecond, "x"); });
    CHECK_THAT(text, Contains("epoll 1 timer at 30\nepoll 1 serial at 40\nepoll 1 timer at 60\n"));
}

TEST_CASE("an edge-triggered serial port is reported once for each byte that comes or goes") {
    const std::string text = run_kit("epoll-edges", [](Bench& bench) { bench.send(80 * kMillisecond, "x"); });
    CHECK_THAT(text,
               Contains("edge 1 4 at 0\nedge 0 0 at 50\nedge 1 5 at 80\nedge 1 5 at 80\nedge 0 0 at 130\n"
                        "i2c -1 Operation not permitted\n"));
}

TEST_CASE("a pipe between threads wakes the reader when it is written") {
    CHECK_THAT(run_kit("pipes"), Contains("pipe p at 12\npoll 1 1 at 2"));
}

TEST_CASE("barriers, read-write locks, once and timed locks") {
    CHECK_THAT(run_kit("locks"),
               Contains("once at 5\nbarrier at 8\njoined at 14\nerrorcheck 0 1\ntimedlock 1 at 18\n"));
}

TEST_CASE("asynchronous reads and writes wait in simulated time") {
    // The pipe's writer writes 30 ms after the limit of 10 ms; what is sent to the port is answered at once.
    const std::string text = run_alike(spec_for("aio"), [](Bench& bench) {
        bench.on_byte = [&bench](Time time, std::uint8_t) { bench.send(time + 20 * kMillisecond, "x"); };
    });
    CHECK_THAT(text, Contains("limit at 10, cancel 1 1\npipe 3 abc at 40\nport 1 1 x, signal 7, at 60\n"
                              "file firstsecond, bad 1 -1\n"));
}

TEST_CASE("a device opened as a stream") {
    const std::string text = run_kit("streams", [](Bench& bench) { bench.send(10 * kMillisecond, "abc\n"); });
    CHECK_THAT(text, Contains("line abc\n"));
}

TEST_CASE("children run in simulated time and may open the port") {
    Bench bench(spec_for("kit", {"children"}));
    bench.run(kSecond);
    CHECK_THAT(bench.log(), Contains("child 6, system 3, pid 1000"));
    CHECK(bench.node().warnings().empty());
}

TEST_CASE("queues, flush and drain report what a UART's driver reports") {
    const std::string text =
        run_kit("modem", [](Bench& bench) { bench.send(5 * kMillisecond, "12345678abc"); });
    // 100 bytes are taken at once and take 8.68 ms to leave.
    CHECK_THAT(text, Contains("waiting 11, cts 1\nflushed 0, write took 0, queue 100, drained after 8\n"));
}

TEST_CASE("a wrapper script may become the program") {
    linuxboard::LinuxSpec spec = spec_for("echo");
    const std::string script = spec.log + ".sh";
    std::ofstream(script) << "#!/bin/sh\nexec " << program("echo") << "\n";
    chmod(script.c_str(), 0755);
    spec.program = script;
    Bench bench(std::move(spec));
    bench.send(5 * kMillisecond, std::string("A\0", 2));
    bench.run(kSecond);
    std::remove(script.c_str());
    CHECK(bench.sent() == "B");
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success);
}
