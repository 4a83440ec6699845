// Programs behind wrappers, and programs of several processes, in simulated time.

#include "base/files/text_file.h"
#include "cosim/core/cores.h"
#include "tests/kit/scratch.h"
#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <sched.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;
using Catch::EndsWith;
using Catch::Matches;
using Catch::StartsWith;

namespace {

struct Ran {
    std::string log, sent, trace;
    std::optional<Stop> stop;
    std::vector<std::string> warnings;
};

Ran run(linuxboard::LinuxSpec spec, Time slice = 70 * kMicrosecond) {
    spec.exit_ends_run = true;
    Bench bench(std::move(spec), slice);
    bench.run(10 * kSecond);
    return {bench.log(), bench.sent(), bench.trace(), bench.node().stop(), bench.node().warnings()};
}

linuxboard::LinuxSpec shell(const std::string& script) {
    linuxboard::LinuxSpec spec = spec_for("beat");
    spec.program = "/bin/sh";
    spec.args = {"-c", script};
    return spec;
}

linuxboard::LinuxSpec family(const std::string& what) {
    return spec_for("family", {what});
}

/// The same with other grants, and with other process numbers and timing of the host.
void check_same(const linuxboard::LinuxSpec& spec, const Ran& first) {
    for (const Time slice : {70 * kMicrosecond, 13 * kMicrosecond}) {
        const Ran again = run(spec, slice);
        CHECK(again.trace == first.trace);
        CHECK(again.log == first.log);
    }
}

/// Runs the test program `clocks` as the shell words `wrapper` reach it.
void check_wrapped(const std::string& wrapper) {
    CAPTURE(wrapper);
    linuxboard::LinuxSpec spec = shell(wrapper);
    spec.start = 2 * kSecond;
    const Ran ran = run(spec);
    REQUIRE(ran.stop);
    CHECK(ran.stop->success);
    CHECK(ran.sent == std::string("\0\1\2\3\4", 5));
    CHECK(to_seconds(ran.stop->time) == Approx(2.3).margin(0.01));
    CHECK_THAT(ran.log, Contains("10001 20001 30001 0\n") && Contains("mono 62"));
    CHECK(ran.warnings.empty());
    check_same(spec, ran);
}

}  // namespace

TEST_CASE("a program reached through a wrapper keeps clock, time and port") {
    const std::string clocks = program("clocks");
    const std::string wrapper = GENERATE_COPY(values<std::string>({
        "exec " + clocks,
        "set -- " + clocks + "; exec \"$@\"",
        "exec /usr/bin/env FOO=1 " + clocks,
        "exec env -i " + clocks,
        "exec stdbuf -oL " + clocks,
        "exec nice " + clocks,
        "exec nohup " + clocks,
        "exec timeout 20 " + clocks,
        clocks + "; echo done",
        clocks + " | tee /dev/null",
        clocks + " 2>&1 | sed s/x/x/ | cat",
        "(" + clocks + " & wait)",
        "(ulimit -n 256; " + clocks + "; echo done)",
        "ulimit -n 16; exec nice " + clocks,
    }));
    check_wrapped(wrapper);
}

TEST_CASE("a program reached from Python keeps clock, time and port") {
    const std::string python = "/usr/bin/python3";
    if (!std::filesystem::exists(python)) {
        WARN("python3 is not there: skipped");
        return;
    }
    const std::string clocks = program("clocks");
    const std::string words = GENERATE_COPY(values<std::string>({
        "import os; os.execv(\"" + clocks + "\", [\"clocks\"])",
        "import subprocess; subprocess.run([\"" + clocks + "\"])",
        "import subprocess; print(subprocess.check_output(\"" + clocks + "\", text=True))",
    }));
    check_wrapped("exec " + python + " -c '" + words + "'");
}

// Python takes locks for each entry of a folder in which it looks for modules, and would write byte code that
// its next start reads.
TEST_CASE("a Python program's first run is as the next ones, whatever else is in its folder") {
    const std::string python = "/usr/bin/python3";
    if (!std::filesystem::exists(python)) {
        WARN("python3 is not there: skipped");
        return;
    }
    const auto folder = scratch_path("python_modules");
    std::filesystem::create_directory(folder);
    const auto write = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder / name) << text;
    };
    write("helper.py", "def word(i):\n    return bytes([i])\n");
    write("robot.py", "import helper, os, time\nf = os.open('/dev/ttyS0', os.O_RDWR)\n"
                      "for i in range(3):\n    os.write(f, helper.word(i))\n    time.sleep(0.01)\n");
    ::unsetenv("PYTHONDONTWRITEBYTECODE");  // of whoever runs the tests
    linuxboard::LinuxSpec spec = spec_for("beat");
    spec.program = python;
    spec.args = {(folder / "robot.py").string()};
    const Ran first = run(spec);
    CHECK(first.sent == std::string("\0\1\2", 3));
    CHECK_FALSE(std::filesystem::exists(folder / "__pycache__"));
    CHECK(run(spec).trace == first.trace);
    for (int i = 0; i < 20; ++i)
        write(fmt::format("more{}.txt", i), "");
    CHECK(run(spec).trace == first.trace);
}

TEST_CASE("calls of a process number mean the program's processes, and reach none of the host") {
    const linuxboard::LinuxSpec own = spec_for("numbers", {"own"});
    const Ran ran = run(own);
    CHECK(ran.log == "failures 0\n");
    CHECK(ran.warnings.size() == 1);  // of the value of sigqueue() to a child
    check_same(own, ran);
    const pid_t stranger = ::fork();
    if (stranger == 0) {
        ::pause();
        ::_exit(0);
    }
    REQUIRE(stranger > 0);
    CHECK(run(spec_for("numbers", {"foreign", std::to_string(stranger)})).log == "failures 0\n");
    CHECK(::waitpid(stranger, nullptr, WNOHANG) == 0);  // it lives
    CHECK(::getpriority(PRIO_PROCESS, static_cast<id_t>(stranger)) == ::getpriority(PRIO_PROCESS, 0));
    ::kill(stranger, SIGKILL);
    ::waitpid(stranger, nullptr, 0);
}

TEST_CASE("locks, queues and semaphores of several processes are waited for in simulated time") {
    const linuxboard::LinuxSpec spec = spec_for("numbers", {"wait"});
    const Ran ran = run(spec);
    const std::string expected =
        "flock at once -#\nflock 0 at 10#\nlockf 0 at 20#\nmsgrcv 4 at 30#\nsemop 0 at 40#\n"
        "semtimedop too late 1 at 45#\nmq_receive 1 at 55#\nsplice 1 at 65#\n"
        "raise 0, kill 0: goes on\n";
    std::string seen = ran.log;  // the last digit of each time is the model's
    for (std::size_t at = 0; (at = seen.find(" at ", at)) != std::string::npos; ++at)
        if (const std::size_t end = seen.find('\n', at);
            end != std::string::npos && std::isdigit(seen[end - 1]) != 0)
            seen[end - 1] = '#';
    CHECK(seen == expected);
    check_same(spec, ran);
}

TEST_CASE("two processes share the port, each in its own rhythm") {
    const Ran ran = run(family("share"));
    // At 20, 30, 40, 60, 60 (the child has made fewer calls, each of which costs something), 80, 90, 120 ms.
    CHECK(ran.sent == "AaBbCDcd");
    CHECK(ran.log == "child 1001 of 1000, its parent 1, status 3 at 120\n");
    check_same(family("share"), ran);
}

TEST_CASE("pipes hold what they hold, and stdio waits for them in simulated time") {
    const Ran ran = run(family("pipes"));
    CHECK(ran.log == "300000 bytes came back, statuses 2, no child is left: 1\n");
    check_same(family("pipes"), ran);
}

TEST_CASE("signals among processes come at simulated times") {
    const Ran ran = run(family("signals"));
    CHECK(ran.log == "SIGCHLD 1 at 25, status 1\nkilled by 9, kill again -1\n");
    check_same(family("signals"), ran);
}

TEST_CASE("a handler is given the sender of its signal, and how a child ended") {
    const Ran ran = run(family("origins"));
    CHECK(ran.log == "asked 1 by child 1, user 1, code 1\nended 1: child 1, user 1, code 1, status 5\n"
                     "raised: self 1\nkilled: code 1, status 15\n");
    check_same(family("origins"), ran);
}

TEST_CASE("a process number that the kernel states is the program's, wherever it comes from") {
    const linuxboard::LinuxSpec spec = spec_for("senders");
    const Ran ran = run(spec);
    CHECK(ran.log == "read: signal 10 by child, user 1, code 0, status 0\n"
                     "readv: signal 17 by child, user 1, code 1, status 5\n"
                     "raised: signal 10 by self, user 1, code -6, status 0\n"
                     "first: signal 10 by child, user 1, code 0, status 0\n"
                     "second: signal 17 by child, user 1, code 1, status 6\n"
                     "unblocked: signal 12 by child\n"
                     "waited for: signal 12 by child\nwaited for: signal 12 by self\n"
                     "peer: self\nsender: child\n"
                     "message by child, semaphore by child, memory of self, used by child, lock of child\n");
    check_same(spec, ran);
}

TEST_CASE("system and popen run their shells in simulated time") {
    const Ran ran = run(family("shells"));
    CHECK_THAT(ran.log, Contains("system 4\n") && Contains(": one\n") && Contains(": two\npclose 0\n") &&
                            Contains("to the child\npclose 6 at 10"));
    check_same(family("shells"), ran);
}

TEST_CASE("spawned processes run in simulated time, those that are nowhere do not") {
    const Ran ran = run(family("spawns"));
    CHECK_THAT(ran.log, Contains("spawned 1001, status 5 at 3") && Contains("nowhere: No such file") &&
                            Contains("vfork 7\n"));
    check_same(family("spawns"), ran);
}

TEST_CASE("a spawned process opens, copies and closes devices as its file actions say") {
    const Ran ran = run(family("spawn-actions"));
    CHECK(ran.sent == "ab");
    CHECK_THAT(ran.log, Contains("spawned 1001, status 5 at 3"));
    CHECK_THAT(ran.log, Contains("nowhere: No such file or directory\nno file: No such file or directory\n"
                                 "not open: Bad file descriptor\nleft: -1\n"));
    check_same(family("spawn-actions"), ran);
}

TEST_CASE("exec keeps the port and the alarm, and closes what is to be closed") {
    const Ran ran = run(family("replace"));
    CHECK(ran.log == "pid 1000 at 20, kept 0, closed -1\nalarm at 1020\n");
    CHECK(ran.sent == "k");
}

TEST_CASE("timeout ends a program that takes too long") {
    const Ran ran = run(shell("timeout 0.5 " + program("polite") + " handler; echo status $?"));
    CHECK_THAT(ran.log, Contains("asked by 15 at 50") && Contains("status 124"));
    CHECK(ran.sent == "R");
}

TEST_CASE("a program that cannot be conducted is refused where it is called, with one line") {
    const Ran replaced = run(shell("exec " + program("static")));
    REQUIRE(replaced.stop);
    CHECK(!replaced.stop->success);
    CHECK_THAT(replaced.stop->reason, Contains("exited with status 126") && Contains("is statically linked"));
    const Ran child = run(shell(program("static") + "; echo status $?; exec " + program("clocks")));
    CHECK_THAT(child.log, Contains("is statically linked") && Contains("status 126\n"));
    CHECK(child.sent == std::string("\0\1\2\3\4", 5));
    CHECK(std::count(child.log.begin(), child.log.end(), 'k') > 0);
}

TEST_CASE(
    "every kind of program that the library cannot be in is refused, at the start and where it is called") {
    const std::string file = scratch_path("puckloop-odd-program").string();
    struct Removed {
        std::string file;
        ~Removed() { std::filesystem::remove(file); }
    } const removed{file};
    std::string image = read_whole_file(program("clocks")).value(), why;
    SECTION("of another processor") {
        image[18] = 40;  // e_machine: ARM
        why = "for another processor";
    }
    SECTION("of 32 bits") {
        image[4] = 1;
        why = "for another processor";
    }
    SECTION("of another C library") {
        const std::string loader = "/lib64/ld-linux-x86-64.so.2";
        const auto place = image.find(loader);
        if (place == std::string::npos) {
            WARN("not on this processor: skipped");
            return;
        }
        std::string other = "/lib/ld-musl-x86_64.so.1";
        other.resize(loader.size());
        image.replace(place, loader.size(), other);
        why = "another C library than glibc";
    }
    SECTION("of another group") {
        why = "setgid";
    }
    std::ofstream(file, std::ios::binary) << image;
    std::filesystem::permissions(file, std::filesystem::perms(0755));
    if (why == "setgid") {
        if (::chown(file.c_str(), geteuid(), getegid() + 1) != 0) {
            WARN("only root can give a file to another group: skipped");
            return;
        }
        REQUIRE(::chmod(file.c_str(), 02755) == 0);
    }
    CAPTURE(why);
    linuxboard::LinuxSpec spec = spec_for("clocks");
    spec.program = file;
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec), Contains(file) && Contains(why));
    const Ran child = run(shell(file + "; echo status $?; exec " + program("clocks")));
    CHECK_THAT(child.log, Contains(why) && Contains("status 126\n"));
    const std::string script = file + ".sh";
    std::ofstream(script) << "#!" << file << "\n";
    std::filesystem::permissions(script, std::filesystem::perms(0755));
    const Removed script_removed{script};
    spec.program = script;
    CHECK_THROWS_WITH(linuxboard::LinuxNode(spec), Contains(file) && Contains(why));
}

TEST_CASE("the signal at the end goes to the process that handles it, and the rest takes its last words") {
    const auto [script, end_ms] = GENERATE(table<std::string, int>(
        {{program("polite") + " handler | cat", 10}, {program("polite") + " handler; sleep 100", 110}}));
    linuxboard::LinuxSpec spec = shell(script);
    Bench bench(spec);
    bench.run(200 * kMillisecond);
    bench.node().wind_up(200 * kMillisecond, 0);
    bench.run(3 * kSecond);
    CHECK(bench.node().wound_up() < (200 + end_ms) * kMillisecond);
    CHECK(bench.sent() == "R");
    CHECK_THAT(bench.log(), Contains("saved at 20"));
}

TEST_CASE("no process of a program outlives its run") {
    const std::string mark = "3141.5" + std::to_string(getpid());
    {
        Bench bench(shell("sleep " + mark + " & sleep " + mark));
        bench.run(100 * kMillisecond);
        CHECK(std::system(("pgrep -f 'sleep " + mark + "' > /dev/null").c_str()) == 0);
    }
    CHECK(std::system(("pgrep -f '[s]leep " + mark + "' > /dev/null").c_str()) != 0);
}

TEST_CASE("a wrapper that dies of the end signal is no cause for a warning") {
    Bench bench(shell("while true; do " + program("polite") + " handler; done"));
    bench.run(200 * kMillisecond);
    bench.node().wind_up(200 * kMillisecond, 0);
    bench.run(3 * kSecond);
    CHECK(bench.node().wound_up() < 320 * kMillisecond);
    CHECK(bench.sent() == "RR");
    CHECK(bench.node().warnings().empty());
}

/// The host's number of the program's first process, which the program itself cannot find out; 0: none.
static pid_t oldest_child() {
    pid_t oldest = 0;
    unsigned long long oldest_start = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "stat");
        std::string text;
        if (!std::getline(file, text) || text.find(')') == std::string::npos) continue;
        std::istringstream fields(text.substr(text.rfind(')') + 2));
        std::string state;
        pid_t parent = 0;
        fields >> state >> parent;
        if (parent != getpid() || state == "Z") continue;
        constexpr int kBetween = 17;  // from pgrp to itrealvalue
        for (int i = 0; i < kBetween; ++i)
            fields >> state;
        unsigned long long start = 0;
        fields >> start;
        const pid_t number = std::atoi(entry.path().filename().c_str());
        if (oldest != 0 && (start > oldest_start || (start == oldest_start && number > oldest))) continue;
        oldest = number;
        oldest_start = start;
    }
    return oldest;
}

TEST_CASE("a first process that is killed while another one lives is named, whoever killed it") {
    SECTION("one of its own, and the other one goes on") {
        Bench bench(shell("while sleep 0.1; do echo on; done & sleep 0.25; kill -9 $$"));
        bench.run(kSecond);
        REQUIRE(bench.node().warnings().size() == 1);
        CHECK_THAT(bench.node().warnings().front(),
                   StartsWith("/bin/sh: its first process was killed by SIGKILL (Killed) at 0.2") &&
                       EndsWith(" more went on"));
        CHECK_THAT(bench.log(), Contains("on\non\non\non\n"));
        bench.node().wind_up(2 * kSecond, 0);
        CHECK_THAT(
            bench.node().finish(),
            Contains("was ended with the run; its first process was killed by SIGKILL (Killed) at 0.2"));
    }
    SECTION("somebody outside, while it waits in simulated time") {
        Bench bench(shell("sleep 50 & sleep 50; true"));
        bench.run(100 * kMillisecond);
        const pid_t first = oldest_child();
        REQUIRE(first > 1);
        REQUIRE(first != getpid());
        REQUIRE(kill(first, SIGKILL) == 0);
        usleep(100'000);
        const bool went_on = GENERATE(false, true);
        CAPTURE(went_on);
        if (went_on) bench.run(150 * kMillisecond);
        bench.node().wind_up(200 * kMillisecond, 0);
        const std::string warnings = fmt::format("{}", fmt::join(bench.node().warnings(), "\n"));
        CHECK_THAT(warnings, Contains("2 more"));
        const std::string before = "its first process was killed by SIGKILL (Killed), noticed at ";
        const std::size_t at = warnings.find(before);
        INFO(warnings);
        REQUIRE(at != std::string::npos);
        const double noticed = std::stod(warnings.substr(at + before.size()));
        // At 10 ms after the look before the kill, or with the first step that begins later; else at the end.
        constexpr double kKilled = 0.1, kLook = 0.01, kStep = 70e-6, kEnd = 0.2, kPrinted = 1e-6;
        if (went_on) {
            CHECK(noticed >= kKilled);
            CHECK(noticed <= kKilled + kLook + kStep + kPrinted);
        } else {
            CHECK(noticed == Approx(kEnd).margin(kPrinted));
        }
    }
    SECTION("nobody: it was asked to end with the run") {
        Bench bench(shell("sleep 50 & sleep 50; true"));
        bench.run(200 * kMillisecond);
        bench.node().wind_up(200 * kMillisecond, 0);
        bench.run(3 * kSecond);
        for (const std::string& warning : bench.node().warnings())
            CHECK_THAT(warning, !Contains("first process"));
    }
}

TEST_CASE("semaphores shared between processes wait in simulated time") {
    const std::string python = "/usr/bin/python3";
    if (!std::filesystem::exists(python)) {
        WARN("python3 is not there: skipped");
        return;
    }
    const auto spec =
        shell("exec " + python +
              " -c 'import multiprocessing as m, time\ndef f(x):\n    time.sleep(x / 10)\n    return x * x\n"
              "with m.get_context(\"fork\").Pool(3) as p: print(p.map(f, [1, 2, 3]))\n"
              "open(\"/dev/ttyS0\")'");
    const Ran ran = run(spec);
    REQUIRE(ran.stop);
    CHECK(ran.log == "[1, 4, 9]\n");
    CHECK(ran.stop->success);
}

TEST_CASE("barriers, conditions and semaphores in shared memory wait in simulated time") {
    const auto lines = [](const char* what) {
        const auto spec = spec_for("sharing", {what, std::to_string(getpid())});
        const Ran ran = run(spec);
        INFO(ran.log);
        REQUIRE(ran.stop);
        CHECK(ran.stop->success);
        CHECK(ran.warnings.empty());
        check_same(spec, ran);
        return ran.log;
    };
    // Who waits for another process looks every millisecond.
    CHECK_THAT(lines("barrier"),
               Matches("round 0 at 4[012]\nround 1 at 8[0-4]\nround 2 at 12[0-6]\nserial 3\n"));
    CHECK_THAT(lines("condition"),
               Matches("value 7 after 1 wait, at 5[01]\ntoo late at 8[01]\nsemaphore at 8[012]\n"));
    CHECK_THAT(lines("file"), Matches("met at 3[012]\n"));
}

TEST_CASE("named pipes wait in simulated time") {
    const std::string pipe = "/tmp/puckloop_pipe_" + std::to_string(getpid());
    const auto spec = shell("rm -f " + pipe + "; mkfifo " + pipe + "; tr a-z A-Z < " + pipe + " & " +
                            program("clocks") + " > " + pipe + "; wait; rm " + pipe);
    const Ran ran = run(spec);
    REQUIRE(ran.stop);
    CHECK(ran.stop->success);
    CHECK_THAT(ran.log, Contains("HOST EPUCK12") && Contains("MONO 60"));
    check_same(spec, ran);
}

TEST_CASE("start scripts see the devices that their programs get") {
    linuxboard::LinuxSpec spec = shell("ls /dev/i2c-77 && test -w /dev/i2c-77 && exec " + program("clocks"));
    spec.i2c = {"/dev/i2c-77"};
    const Ran ran = run(spec);
    CHECK_THAT(ran.log, StartsWith("/dev/i2c-77\nhost epuck12\n"));
}

TEST_CASE("a program has none of the files that puckloop has open, however many") {
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_NOFILE, &before) == 0);
    rlimit raised = before;
    raised.rlim_cur = raised.rlim_max;
    REQUIRE(::setrlimit(RLIMIT_NOFILE, &raised) == 0);
    std::vector<int> open_here;  // as with some hundred robots in one process, if the host lets it
    constexpr int kMany = 1100;
    for (int fd = 0; fd >= 0 && open_here.size() < kMany;)
        if (fd = ::dup(STDERR_FILENO); fd >= 0) open_here.push_back(fd);
    REQUIRE(open_here.size() > 10);
    for (int i = 0; i < 10; ++i) {  // room for the bench itself
        ::close(open_here.back());
        open_here.pop_back();
    }
    const Ran ran = run(shell("exec 9<>/dev/ttyS0; for f in 3 4 5 6 7 8 10 11 77 1000; do "
                              "[ -e /proc/self/fd/$f ] && echo has $f; done; echo end; ulimit -n"));
    for (const int fd : open_here)
        ::close(fd);
    ::setrlimit(RLIMIT_NOFILE, &before);
    CHECK_THAT(ran.log, StartsWith("end\n"));
    REQUIRE(ran.stop);
    CHECK(ran.stop->success);
}

TEST_CASE("a program finds all cores, whichever one the run keeps to") {
    const std::string all = run(shell("nproc")).log;
    cosim::use_one_core(static_cast<std::uint32_t>(::sched_getcpu()));
    const std::string from_one_core = run(shell("nproc")).log;
    cosim::use_all_cores();
    CHECK_THAT(all, StartsWith(std::to_string(cosim::usable_cores()) + "\n"));
    CHECK(from_one_core == all);
}
