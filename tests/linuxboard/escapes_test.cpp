// Ways out of simulated time, and ways to harm the run: conducted, or named.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <sys/prctl.h>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;

namespace {
struct Ran {
    std::string sent, log, trace, reason;
    bool success = false;
};

Ran run(std::vector<std::string> args, Time slice = 70 * kMicrosecond) {
    linuxboard::LinuxSpec spec = spec_for("escapes", std::move(args));
    spec.watchdog_s = 3.0;
    Bench bench(std::move(spec), slice);
    bench.run(3 * kSecond);
    const auto stop = bench.node().stop();
    bench.run(bench.now() + 20 * kMillisecond, true);  // what is still to go out
    return {bench.sent(), bench.log(), bench.trace(), stop ? stop->reason : "", stop && stop->success};
}
}  // namespace

TEST_CASE("processes made past fork() run in simulated time") {
    const std::string how = GENERATE(
        values<std::string>({"SYS_fork", "SYS_clone", "SYS_clone3", "_Fork", "clone", "clone-vfork"}));
    CAPTURE(how);
    const Ran ran = run({how});
    CAPTURE(ran.reason);
    CHECK(ran.log == "child 1001, ended 1001, status 5\n");
    CHECK(ran.sent == "cp");
    CHECK(ran.success);
    const Ran again = run({how}, 13 * kMicrosecond);
    CHECK(again.trace == ran.trace);
}

TEST_CASE("what nobody can conduct is refused by name with status 126") {
    const auto [how, name] = GENERATE(table<std::string, std::string>({{"clone-memory", "clone()"},
                                                                       {"SYS_clone-thread", "SYS_clone"},
                                                                       {"io_uring", "io_uring_setup"},
                                                                       {"ptrace", "ptrace()"},
                                                                       {"unshare", "unshare()"},
                                                                       {"SYS_unshare", "SYS_unshare"},
                                                                       {"setns", "setns()"},
                                                                       {"SYS_setns", "SYS_setns"},
                                                                       {"seccomp", "PR_SET_SECCOMP"},
                                                                       {"SYS_seccomp", "SYS_seccomp"},
                                                                       {"SYS_prctl", "PR_SET_SECCOMP"},
                                                                       {"dispatch", "USER_DISPATCH"},
                                                                       {"SYS_ptrace", "SYS_ptrace"}}));
    CAPTURE(how);
    const Ran ran = run({how});
    CHECK(!ran.success);
    CHECK_THAT(ran.reason, Contains("exited with status 126") && Contains(name));
}

TEST_CASE(
    "namespaces apart, unshare() and prctl() are the kernel's, and the run's end takes a program along") {
    const Ran ran = run({"harmless"});
    CHECK(ran.log == "unshare 0, name robot, death signal 15, none 0, wrong -1\n");
    CHECK(ran.success);
}

TEST_CASE("a device opened by syscall() is the board's") {
    CHECK(run({"SYS_openat"}).sent == "ok");
}

TEST_CASE("a system call that a program makes by itself is the one that the C library makes") {
#if defined(__x86_64__)
    if (::prctl(59 /* PR_SET_SYSCALL_USER_DISPATCH */, 0, 0, 0, 0) != 0) {
        WARN("this kernel cannot hand on system calls: skipped");
        return;
    }
#endif
    const Ran opened = run({"direct-openat"});
    CHECK(opened.sent == "ok");
    CHECK(opened.log == "-2 -9\n");  // ENOENT, EBADF
    const Ran timed = run({"direct-clock"});
    CHECK(timed.log == "10001 us, own clock page 0\n");
    CHECK(run({"direct-clock"}, 13 * kMicrosecond).log == timed.log);
    const Ran forked = run({"direct-fork"});
    CHECK(forked.log == "child 1001, ended 1001, status 5\n");
    CHECK(forked.sent == "cp");
    CHECK(run({"direct-signals"}).log == "set 0, handled 0, then 1, 1, stack 1\n");
    const Ran thread = run({"direct-thread"});
    CHECK(thread.sent == "mt");
    CHECK(thread.success);
    const Ran refused = run({"direct-io_uring"});
    CHECK_THAT(refused.reason, Contains("exited with status 126") && Contains("io_uring_setup"));
}

TEST_CASE("a program cannot cut the memory that it shares with the run") {
    const Ran ran = run({"truncate"});
    CHECK(ran.log == "found 1, ftruncate -1 1\nagain -1\n");
    CHECK(ran.success);
}

TEST_CASE("a program that writes over the shared memory harms itself alone") {
    for (int seed = 1; seed <= 20; ++seed) {
        CAPTURE(seed);
        const Ran ran = run({"scribble", std::to_string(seed)});
        CHECK(ran.log.size() < 100'000);  // whatever it came to, the run is here to tell
    }
}

TEST_CASE("closing every descriptor leaves the link, and a limit of file sizes the log") {
    CHECK(run({"close"}).sent == "ok");
    const Ran ran = run({"file-size"});
    CHECK(ran.sent == "ok");
    CHECK(ran.log == "limit 0\n");
}

TEST_CASE("a program that loops in its own fault handler is named as such") {
    const Ran ran = run({"segv-loop"});
    CHECK_THAT(ran.reason, Contains("loops in its own handler of SIGSEGV") && Contains("test_escapes+0x") &&
                               Contains("address 0x0"));
}

TEST_CASE("a fault whose signal is ignored ends the program, as the kernel does it") {
    CHECK_THAT(run({"segv-default"}).reason, Contains("SIGSEGV"));
}

TEST_CASE("processor time is what calls are charged, in every interface, and waiting is none") {
    const Ran ran = run({"processor-time"});
    // process, thread, its clock by number, clock(), getrusage, times; user time, children, maxrss
    CHECK(ran.log == "0.00 0.00 0.00 0.00 0.00 0.00 0.00 0.00 0\n"
                     "0.10 0.10 0.10 0.10 0.10 0.10 0.00 0.00 0\n"
                     "0.10 0.10 0.10 0.10 0.10 0.10 0.00 0.05 0\n");
    CHECK(run({"processor-time"}, 13 * kMicrosecond).log == ran.log);
}
