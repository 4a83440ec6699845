// Runs that are ended from outside: signals, lost processes, a full disk. What was recorded is kept.

#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fstream>

#include <sys/mount.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kHello = PUCKLOOP_SOURCE "/scenarios/hello.toml";

bool wait_for(const std::function<bool()>& condition, double limit = 60.0) {
    for (const double begun = wall_seconds(); wall_seconds() - begun < limit;) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
}

/// A run of an hour, once it has recorded two seconds.
struct LongRun {
    const Workbench& bench;
    std::unique_ptr<Process> process;
    std::vector<pid_t> family;  ///< the processes it started, theirs too

    LongRun(const Workbench& a_bench, const Words& more) : bench(a_bench) {
        Words words{"run", kHello, "--duration", "3600", "--out", bench.out("o")};
        words.insert(words.end(), more.begin(), more.end());
        process = bench.start(words);
        const auto recorded = [this] {
            return text_of(bench.out("o") / "trajectory.csv").find("\n2.000,") != std::string::npos;
        };
        REQUIRE(wait_for(recorded));
        for (const pid_t child : process->children()) {
            family.push_back(child);
            for (const pid_t grandchild : children_of(child))
                family.push_back(grandchild);
        }
    }

    /// The node process that has a child (the Linux program's), or one that has none.
    pid_t node(bool with_child) const {
        for (const pid_t child : process->children())
            if (children_of(child).empty() != with_child) return child;
        return -1;
    }

    void check_no_orphans() const {
        CHECK(!family.empty());
        CHECK(all_end(family));
    }

    void check_kept(const std::string& ended_by) const {
        const auto report = bench.report("o");
        CHECK(report["ended_by"] == ended_by);
        CHECK(report["simulated_s"] >= 1.9);
        CHECK(report["trace_sha256"].get<std::string>().size() == 64);
        CHECK(bench.csv("o", "trajectory.csv").size() >= 20);
        const auto trace = bench.csv("o", "trace.csv");
        REQUIRE(!trace.empty());
        CHECK(std::stod(trace.back().at("time_s")) > 1.9);
        CHECK_THAT(text_of(bench.out("o") / "trajectory.svg"), Contains("</svg>"));
        CHECK(!std::filesystem::exists(bench.out("o") / "report.json.part"));
    }
};

/// At "disk" in the test's folder; false, with a warning, where that is not allowed.
bool mount_small_disk(const Workbench& bench, const char* size) {
    const auto disk = bench.folder() / "disk";
    std::filesystem::create_directory(disk);
    if (geteuid() == 0 && ::mount("tmpfs", disk.c_str(), "tmpfs", 0, size) == 0) return true;
    WARN("a small disk cannot be mounted here: skipped");
    return false;
}

}  // namespace

TEST_CASE("a signal ends the run with the shell's status, a report and no orphans") {
    const auto [number, name, placement] = GENERATE(table<int, std::string, Words>(
        {{SIGINT, "SIGINT", {}}, {SIGTERM, "SIGTERM", {}}, {SIGINT, "SIGINT", {"--in-process"}}}));
    const Workbench bench;
    const LongRun run(bench, placement);
    const double before = wall_seconds();
    run.process->signal(number);
    const Ended ended = run.process->wait();
    CHECK(wall_seconds() - before < 10.0);
    check_one_line(ended, 128 + number, {"interrupted", name}, 120);
    run.check_kept("interrupted");
    run.check_no_orphans();
}

TEST_CASE("a node process that is killed ends the run with its name and last time") {
    const bool with_child = GENERATE(false, true);
    const Workbench bench;
    const LongRun run(bench, {});
    const pid_t victim = run.node(with_child);
    REQUIRE(victim > 0);
    const double before = wall_seconds();
    ::kill(victim, SIGKILL);
    const Ended ended = run.process->wait();
    CHECK(wall_seconds() - before < 10.0);
    check_one_line(ended, 1,
                   {with_child ? "node robot0.linux" : "node ", "process " + std::to_string(victim),
                    "killed by signal 9", "last simulated time"},
                   120);
    run.check_kept("failed");
    run.check_no_orphans();
}

TEST_CASE("the Linux program killed from outside is named") {
    const Workbench bench;
    const LongRun run(bench, {});
    const pid_t node = run.node(true);
    REQUIRE(node > 0);
    ::kill(children_of(node).front(), SIGKILL);
    check_one_line(run.process->wait(), 1, {"robot0.linux", "puckloop-control", "SIGKILL"}, 120);
    run.check_kept("node stopped");
    run.check_no_orphans();
}

TEST_CASE("a node process that stalls is found within the asked time") {
    const Workbench bench;
    const LongRun run(bench, {"--stall", "2"});
    const pid_t victim = run.node(false);
    REQUIRE(victim > 0);
    const double before = wall_seconds();
    ::kill(victim, SIGSTOP);
    const Ended ended = run.process->wait();
    CHECK(wall_seconds() - before < 15.0);
    check_one_line(ended, 1, {"node ", std::to_string(victim), "has not answered", "last simulated time"},
                   120);
    run.check_kept("failed");
    run.check_no_orphans();
}

TEST_CASE("the run itself killed takes its processes along and leaves what it recorded") {
    const Workbench bench;
    const LongRun run(bench, {});
    run.process->signal(SIGKILL);
    CHECK(run.process->wait().status == 128 + SIGKILL);
    run.check_no_orphans();
    CHECK(bench.csv("o", "trajectory.csv").size() >= 20);
}

TEST_CASE("a full disk ends the run with what fits, and a report") {
    const Workbench bench;
    if (!mount_small_disk(bench, "size=512k")) return;
    const auto disk = bench.folder() / "disk";
    for (const char* placement : {"--in-process", "--json"}) {
        const Ended ended = bench.run("disk/o", {kHello, "--duration", "30", placement});
        check_one_line(ended, 1, {"disk/o/", "No space left on device"}, 60);
        CHECK(bench.csv("disk/o", "trajectory.csv").size() > 5);
        CHECK(bench.csv("disk/o", "trace.csv").size() > 1000);
        CHECK_THAT(bench.report("disk/o")["ended_why"].get<std::string>(), Contains("No space left"));
        std::filesystem::remove_all(disk / "o");
    }
    CHECK(::umount(disk.c_str()) == 0);
}

TEST_CASE("a limit of file sizes ends the run with what fits and the file's name, not by a signal") {
    const Workbench bench;
    const auto limited = [&bench](const char* blocks, const Words& more) {
        Words words{"sh",
                    "-c",
                    std::string("ulimit -f ") + blocks + " && exec \"$0\" \"$@\"",
                    PUCKLOOP_PROGRAM,
                    "run",
                    kHello,
                    "--duration",
                    "200",
                    "--record",
                    "--out",
                    bench.out("o")};
        words.insert(words.end(), more.begin(), more.end());
        return Process(words, bench.folder()).wait();
    };
    for (const Words& placement : {Words{}, Words{"--in-process"}}) {
        check_one_line(limited("8000", placement), 1, {"o/record.csv", "File too large"},
                       60);  // of 512 bytes
        CHECK_THAT(bench.report("o")["ended_why"].get<std::string>(), Contains("File too large"));
        check_one_line(limited("16", placement), 1, {"ulimit -f"}, 60);
    }
}

TEST_CASE("a snapshot that finds no room is not reported") {
    const Workbench bench;
    if (!mount_small_disk(bench, "size=64k")) return;
    const auto file = bench.folder() / "disk" / "run.snap";
    const Ended ended = bench.run(
        "o", {kHello, "--duration", "1", "--in-process", "--save-at", "0.5", "--save", file.string()});
    check_one_line(ended, 1, {"run.snap: cannot be written: No space left on device"});
    CHECK_THAT(ended.out, !Contains("snapshot of"));
    CHECK_FALSE(std::filesystem::exists(file));
    CHECK(::umount((bench.folder() / "disk").c_str()) == 0);
}

TEST_CASE("an export that cannot be written hides nothing of the run") {
    const Workbench bench;
    std::filesystem::create_directories(bench.out("o") / "trace.vcd");
    std::ofstream(bench.out("o") / ".puckloop") << "trace.vcd\n";  // a folder of ours
    const Ended ended =
        bench.run("o", {kHello, "--duration", "0.3", "--in-process", "--trace-format", "vcd"});
    check_one_line(ended, 1, {"trace.vcd: cannot be written"});
    CHECK_THAT(ended.out, Contains("ended: ") && Contains("results in "));
}

TEST_CASE(
    "a disk that is too small for anything ends the run, with a report or the word that there is none") {
    const Workbench bench;
    unsigned reports = 0;
    for (const int kilobytes : {4, 8, 16, 24, 36, 64, 160}) {
        if (!mount_small_disk(bench, fmt::format("size={}k", kilobytes).c_str())) return;
        const auto disk = bench.folder() / "disk";
        for (const char* placement : {"--in-process", "--record"}) {
            CAPTURE(kilobytes, placement);
            const Ended ended = bench.run("disk/o", {kHello, "--duration", "30", placement});
            check_one_line(ended, 1, {"disk/o/", "No space left on device"}, 60);
            const bool named = ended.err.find("report.json: cannot be written") != std::string::npos;
            const bool there = std::filesystem::exists(disk / "o" / "report.json");
            CHECK(there != named);
            if (there)
                CHECK_THAT(bench.report("disk/o")["ended_why"].get<std::string>(), Contains("No space"));
            reports += there;
            CHECK(!std::filesystem::exists(disk / "o" / "report.json.part"));
            std::filesystem::remove_all(disk / "o");
        }
        CHECK(::umount(disk.c_str()) == 0);
    }
    CHECK(reports >= 10);  // of 14: a quarter of such a disk is the report's
}
