// What a program finds of its computer is the board's, and ways to wait beside POSIX's are conducted.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;

namespace {
struct Ran {
    std::string sent, log, trace;
    Time stopped = 0;
};

Ran run(const std::string& how, Time slice = 70 * kMicrosecond) {
    Bench bench(spec_for("board", {how}), slice);
    bench.run(3 * kSecond);
    const auto stop = bench.node().stop();
    return {bench.sent(), bench.log(), bench.trace(), stop ? stop->time : 0};
}
}  // namespace

TEST_CASE("threads, locks and conditions of C11 wait in simulated time") {
    const Ran ran = run("c11");
    CHECK(ran.log == "once\nslept 0 at 30\nslept 0 at 70\nready at 70\ntimed out 1 at 90\njoined 5 at 90\n");
    CHECK(run("c11", 13 * kMicrosecond).log == ran.log);
}

TEST_CASE(
    "a signal for a thread reaches it in simulated time, one for the process the thread that takes it") {
    const Ran ran = run("signals");
    CHECK(ran.log == "killed 0 at 30\nsignal 10 in the other at 30\nwoken 1 at 30\n"
                     "signal 12 in the first at 50\ninterrupted 1 at 50\n"
                     "signal 10 in the other at 80\nwoken 1 at 80\n"
                     "waited for 1 at 90\nunblocking\nsignal 10 in the first at 90\n"
                     "signal 14 in the first at 1090\npaused until 1090\n");
    CHECK(run("signals", 13 * kMicrosecond).log == ran.log);
}

TEST_CASE("/proc, folders and the kernel's figures are the board's, the same in each run") {
    const Ran ran = run("computer");
    CHECK_THAT(ran.log, Contains("/proc/uptime: 60.50 60.49\n"));
    CHECK_THAT(ran.log, Contains("/proc/loadavg: 0.00 0.00 0.00 1/1 1000\n"));
    CHECK_THAT(ran.log, Contains("/proc/self/stat: 1000 (test_board) R 1 1000 1000 "));
    CHECK_THAT(ran.log, Contains("/proc/1000/stat: 1000 (test_board) R 1 1000 1000 "));
    CHECK_THAT(ran.log, Contains("/proc/self -> 1000\n"));
    CHECK_THAT(ran.log, Contains("/proc/self/fd/3 -> /dev/ttyS0\n"));
    CHECK_THAT(ran.log, Contains("/proc: 1000\n"));
    CHECK_THAT(ran.log, Contains("/dev: i2c-3\n"));
    CHECK_THAT(ran.log, Contains("/proc/self/fd: 0 1 2 3 4\n"));
    CHECK_THAT(ran.log, Contains("up 60 s, 1 process, processor 0\n"));
    CHECK_THAT(ran.log, Contains("attributes 0 -1 No data available\n"));
    CHECK_THAT(ran.log, Contains("preadv2 -1 Illegal seek\n"));
    CHECK(run("computer").log == ran.log);
}

TEST_CASE("each way to list a folder finds the board's processes and devices") {
    Bench bench(spec_for("folders"));
    bench.run(3 * kSecond);
    const std::string log = bench.log();
    const auto folder = [](const std::string& path, const std::string& names) {
        return fmt::format("{0}\nreaddir: {1}\nrewinddir: {1}\nseekdir: 1\nscandir: {1}\nglob: {1}\n"
                           "fts_read: {1}\ngetdents64: {1}\ngetdents: {1}\n",
                           path, names);
    };
    CHECK_THAT(log, Contains(folder("/proc", "1000 1001 1002 1003")));
    CHECK_THAT(log, Contains(folder("/dev", "i2c-3 ttyS0") + "nftw: i2c-3 ttyS0\n"));
    CHECK_THAT(log, Contains("of processes 4, /proc/1001/fd, a device 0, another 3\n"
                             "a device is no folder: 1\n"));
}

TEST_CASE("the last close of the serial port takes until what was written is out") {
    constexpr Time kOut = 300 * 10 * kSecond / 115'200;
    const std::string how = GENERATE(values<std::string>({"leave", "close", "die"}));
    CAPTURE(how);
    const Ran ran = run(how);
    CHECK(ran.sent == std::string(300, 'x'));
    CHECK(ran.stopped >= kOut);
    CHECK(ran.stopped < kOut + 2 * kMillisecond);
    if (how == "close") CHECK(ran.log == "a copy is open at 0\nclosed at 26\n");
    CHECK(run(how, 13 * kMicrosecond).trace == ran.trace);
}
