// Programs that end early, crash, hang or cannot run at all: one clear message each.

#include "base/error.h"
#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <unistd.h>

#include <csignal>
#include <vector>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;

namespace {
std::string reason_of(linuxboard::LinuxSpec spec, bool success) {
    Bench bench(std::move(spec));
    bench.run(kSecond);
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success == success);
    return bench.node().stop()->reason;
}
}  // namespace

TEST_CASE("a crash is named with its signal and the program's last words") {
    const std::string reason = reason_of(spec_for("misbehave", {"crash"}), false);
    CHECK_THAT(reason, Contains("SIGSEGV") && Contains("about to follow a null pointer"));
}

TEST_CASE("an exit status other than 0 fails the run") {
    CHECK_THAT(reason_of(spec_for("misbehave", {"fail"}), false),
               Contains("exited with status 7") && Contains("no robot here"));
}

TEST_CASE("a program that never opens the port is reported") {
    CHECK_THAT(reason_of(spec_for("misbehave", {"never-opens"}), false),
               Contains("without ever opening /dev/ttyS0"));
}

TEST_CASE("a program that lets no time pass is found by the watchdog") {
    linuxboard::LinuxSpec spec = spec_for("misbehave", {"spin"});
    spec.watchdog_s = 0.3;
    CHECK_THAT(reason_of(std::move(spec), false),
               Contains("it computes without any call that lets time pass") && Contains("sleep"));
}

TEST_CASE("a polling loop lets time pass") {
    Bench bench(spec_for("misbehave", {"poll"}));
    bench.send(20 * kMillisecond, "x");
    bench.run(kSecond);
    // From the 5 ms sleep to 20 ms, a character and four characters' pause of the FIFO, at 2 us a poll.
    CHECK_THAT(bench.log(), Contains("polls, then x"));
    CHECK(std::stol(bench.log()) == Approx(7714).margin(10));
}

TEST_CASE("signals interrupt or restart a blocked read as sigaction asks") {
    linuxboard::LinuxSpec spec = spec_for("misbehave", {"signal"});
    spec.signals = {{10 * kMillisecond, SIGINT}, {40 * kMillisecond, SIGTERM}, {40 * kMillisecond, SIGUSR1}};
    Bench bench(std::move(spec));
    bench.send(30 * kMillisecond, "x");
    bench.run(kSecond);
    CHECK(bench.log() == "read 1 after signal 2\nread -1 after signal 15\n");
}

TEST_CASE("an unsupported ioctl is named once with its place") {
    Bench bench(spec_for("misbehave", {"odd-ioctl"}));
    bench.run(kSecond);
    REQUIRE(bench.node().warnings().size() == 1);
    CHECK_THAT(bench.node().warnings()[0],
               Contains("/dev/ttyS0: ioctl 0x5470") && Contains("test_misbehave"));
}

TEST_CASE("a program is killed and started anew where the scenario asks for it") {
    linuxboard::LinuxSpec spec = spec_for("clocks");
    spec.restarts = {{100 * kMillisecond, 50 * kMillisecond}};
    Bench bench(std::move(spec));
    bench.run(kSecond);
    CHECK(bench.sent() == std::string("\0\0\1\2\3\4", 6));
    CHECK(bench.node().stop());
    CHECK(to_seconds(bench.node().stop()->time) == Approx(0.45).margin(0.001));
}

TEST_CASE("what cannot be run is refused before the run") {
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec_for("not_there")), Contains("No such file"));
    linuxboard::LinuxSpec spec = spec_for("static");
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec), Contains("statically linked"));
    spec.program = __FILE__;
    CHECK_THROWS_AS(linuxboard::LinuxNode(spec), InputError);
    spec.program = program("echo");
    spec.cwd = "/nowhere/at/all";
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec), Contains("/nowhere/at/all"));
}

TEST_CASE("a program that dies before it begins leaves its reason, or that it gave none") {
    linuxboard::LinuxSpec spec = spec_for("echo");
    spec.shim = std::string(PUCKLOOP_TEST_PROGRAMS) + "/libtest_quitter.so";
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec),
                      Contains("exited with status 125 before it began: it printed nothing"));
    spec.env = {{"QUITTER_SAYS", "no memory for the page"}};
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec),
                      Contains("exited with status 125 before it began: no memory for the page"));
    spec.log.clear();
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec), Contains("before it began: its output is not kept"));
}

TEST_CASE("a program starts wherever its descriptors lie in the process that runs it") {
    constexpr int kAroundPrivate = 490, kTries = 16;
    std::vector<int> held;
    while (held.empty() || held.back() < kAroundPrivate)
        held.push_back(dup(STDIN_FILENO));
    for (int i = 0; i < kTries; ++i) {
        CHECK_NOTHROW(linuxboard::LinuxNode(spec_for("echo")));
        held.push_back(dup(STDIN_FILENO));
    }
    for (const int fd : held)
        close(fd);
}
