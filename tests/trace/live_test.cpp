// `run --live`: the trace as pcapng while the run goes on.

#include "trace_kit.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

using namespace puckloop::tests;

namespace {

std::string run_with(const std::string& options, const std::string& out) {
    return fmt::format("run {}/scenarios/rab_pair.toml --in-process --out {} {}", PUCKLOOP_SOURCE, out,
                       options);
}

}  // namespace

TEST_CASE("what a named pipe got while the run went on is what is exported afterwards") {
    const std::string out = scratch("live"), pipe = scratch("live.pipe"), got = scratch("live.pcapng");
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const Called run = shell(fmt::format("cat {} > {} & {} {} 2>&1; wait", pipe, got, PUCKLOOP_PROGRAM,
                                         run_with("--duration 0.3 --live " + pipe, out)));
    INFO(run.out);
    CHECK_THAT(run.out, Catch::Contains("waiting for a reader of " + pipe) && Catch::Contains("trace "));
    REQUIRE(puckloop::tests::puckloop(fmt::format("trace export {} --format pcapng -o {}.again", out, got))
                .status == 0);
    CHECK(std::filesystem::file_size(got) > 1000);
    CHECK(shell(fmt::format("cmp {0} {0}.again", got)).status == 0);
    if (installed("tshark")) {
        const Called some =
            shell(fmt::format("tshark -r {} -c 3 -T fields -e frame.interface_name 2>&1", got));
        CHECK_THAT(some.out, Catch::Contains("leader.i2c") || Catch::Contains("leader.uart"));
    }
    // The standard output is the same, and nothing else is in it.
    REQUIRE(shell(fmt::format("{} {} > {} 2> {}.err", PUCKLOOP_PROGRAM,
                              run_with("--duration 0.3 --live -", out), got, got))
                .status == 0);
    CHECK(shell(fmt::format("cmp {0} {0}.again", got)).status == 0);
}

TEST_CASE("packets come before the run ends, and it goes on when their reader has gone") {
    const std::string out = scratch("early"), pipe = scratch("early.pipe"), said = scratch("early.txt");
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    // Paced, so that there is an end to be early for.
    Called run;
    std::thread runner([&] {
        run = shell(fmt::format("{} {} > {} 2>&1", PUCKLOOP_PROGRAM,
                                run_with("--paced --duration 3 --live " + pipe, out), said));
    });
    const int descriptor = open(pipe.c_str(), O_RDONLY | O_CLOEXEC);
    REQUIRE(descriptor >= 0);
    std::size_t count = 0;
    char buffer[256];
    while (count < 4000) {
        const ssize_t size = read(descriptor, buffer, sizeof buffer);
        if (size <= 0) break;
        count += static_cast<std::size_t>(size);
    }
    const bool ended = std::filesystem::exists(out + "/report.json");
    close(descriptor);
    runner.join();
    CHECK(count >= 4000);
    CHECK_FALSE(ended);
    CHECK(run.status == 0);
    CHECK_THAT(shell("cat " + said).out, Catch::Contains("its reader has gone; the run goes on"));
    CHECK(std::filesystem::exists(out + "/report.json"));
}

TEST_CASE("a run that nobody reads can be interrupted, with the status of Ctrl-C") {
    const std::string out = scratch("alone"), pipe = scratch("alone.pipe");
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const Called run = shell(fmt::format("timeout --preserve-status -s INT 1 {} {} 2>&1", PUCKLOOP_PROGRAM,
                                         run_with("--live " + pipe, out)));
    CHECK(run.status == 128 + SIGINT);
    CHECK_THAT(run.out, Catch::Contains("interrupted while nobody read " + pipe));
}

TEST_CASE("what cannot be written live is refused in one line, a full disk when it is full") {
    for (const std::string place : {"/nonexistent/x", "/tmp"}) {
        const Called called =
            puckloop::tests::puckloop(run_with("--duration 0.1 --live " + place, scratch("bad")));
        INFO(called.out);
        CHECK(called.status == 2);
        CHECK(lines_of(called.out).size() == 1);
        CHECK_THAT(called.out, Catch::Contains("--live: cannot be written"));
    }
    const Called full =
        puckloop::tests::puckloop(run_with("--duration 0.3 --live /dev/full", scratch("full")));
    INFO(full.out);
    CHECK(full.status == 1);
    CHECK_THAT(full.out, Catch::Contains("/dev/full: cannot write: No space left on device"));
}
