// ARGoS's real-robot program, unmodified (PUCKLOOP_ARGOS: a folder with argos_epuck and avoid.argos), started
// as laboratories start it: from scripts, through pipelines, by Python. Its session is whole, down to the
// last 'R'.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <filesystem>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

constexpr std::size_t kHandshake = 5, kFrame = 12, kCommand = 10;

struct Habit {
    const char* name;
    const char* script;
    const char* says;  ///< in the log, beside what the program prints
};

constexpr Habit kHabits[]{
    {"exec.sh", "#!/bin/sh\ncd \"$(dirname \"$0\")\" || exit 1\nexport ROBOT=\"$(hostname)\"\nexec \"$@\"\n",
     "step"},
    {"plain.sh", "#!/bin/bash -e\n\"$@\"\necho \"ended with $?\"\n", "ended with 0"},
    {"tee.sh", "#!/bin/bash\n\"$@\" 2>&1 | tee /dev/null | sed -u 's/^/LOG /'\n", "LOG"},
    {"background.sh",
     "#!/bin/bash\n\"$@\" &\ntrap 'kill -INT $!' TERM INT\nwait $!\nwait $!\necho \"child said $?\"\n",
     "child said 0"},
    {"subprocess.py",
     "#!/usr/bin/python3 -I\nimport signal, subprocess, sys\nchild = subprocess.Popen(sys.argv[1:])\n"
     "signal.signal(signal.SIGINT, lambda *_: child.terminate())\nprint('status', child.wait(), "
     "flush=True)\n",
     "status 0"},
};

}  // namespace

TEST_CASE("ARGoS's program behind a laboratory's scripts keeps its session, to the last R", "[argos]") {
    const auto program = outside("PUCKLOOP_ARGOS", "argos_epuck");
    const auto experiment = outside("PUCKLOOP_ARGOS", "avoid.argos");
    if (!program || !experiment) {
        WARN("PUCKLOOP_ARGOS has no argos_epuck and avoid.argos: skipped");
        return;
    }
    const Habit& habit = kHabits[GENERATE(0, 1, 2, 3, 4)];
    INFO(habit.name);
    const Workbench bench;
    // A folder of its own: Python looks through that of its script.
    std::filesystem::create_directory(bench.folder() / "robot");
    const auto script = bench.file(std::string("robot/") + habit.name, habit.script);
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    for (const char* placement : {"--in-process", "--json"}) {
        const Ended ended =
            bench.run(placement, {bench.hello("end_signal = \"INT\"\n"), "--duration", "3.95", placement,
                                  "--linux", script, *program, "-c", *experiment, "-i", "avoid"});
        INFO(ended.out << ended.err << text_of(bench.out(placement) / "robot0.linux.log"));
        REQUIRE(ended.status == 0);
        const auto sent = bytes_sent(bench.csv(placement, "trace.csv"), "robot0.uart", "robot0.linux");
        REQUIRE(sent.size() > kHandshake);
        REQUIRE((sent.size() - kHandshake) % kFrame == 0);
        const std::size_t frames = (sent.size() - kHandshake) / kFrame;
        CHECK(frames >= 28);
        CHECK(frames <= 32);
        for (std::size_t i = 0; i < frames; ++i)
            CHECK(sent[kHandshake + i * kFrame + kCommand] == (i + 1 < frames ? 'N' : 'R'));
        const std::string log = text_of(bench.out(placement) / "robot0.linux.log");
        CHECK_THAT(log, Contains("Destruction completed") && Contains(habit.says));
    }
    check_same_run(bench, "--in-process", "--json");
}
