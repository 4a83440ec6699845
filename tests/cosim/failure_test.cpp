// Peers that die, stall or lie: the run ends soon, names who and when and why, and loses nothing.

#include "toy_run.h"

#include "base/error.h"
#include "cosim/interrupt.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

// "Within seconds", also on a machine with ten other things to do.
constexpr double kSoon = 5.0;
// A process that is only slow there, be it to start, must not look like one that answers no more.
constexpr double kStall = 2.0;

/// Two nodes that chat for ever, and one that does `line`; all in processes of their own.
Run with_third(const std::string& line) {
    Run run{{{"left", "echo first=1"}, {"right", "echo"}, {"third", line}},
            {toy::uart("wire", {"left", "uart0"}, {"right", "uart0"})}};
    run.options.duration = 100 * kMillisecond;
    return run;
}

bool no_children_left() {
    return waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD;
}

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

TEST_CASE("a node that ends by itself is named with its last time and the cause") {
    const auto [line, cause] = GENERATE(table<std::string, std::string>({
        {"exiter at_us=50000", "exited with status 3"},
        {"aborter at_us=50000", "was killed by signal 6 (Aborted)"},
        {"thrower at_us=50000", "stopped at simulated time 0.0"},
    }));
    Recorder recorder;
    Outcome outcome;
    const double wall = seconds_of([&] { outcome = with_third(line)(&recorder); });
    CHECK(outcome.reason == EndReason::Failed);
    CHECK_FALSE(outcome.success);
    CHECK(outcome.node == "third");
    CHECK_THAT(outcome.text, Catch::Contains("node third") && Catch::Contains(cause));
    CHECK(outcome.simulated <= 50 * kMillisecond);
    CHECK(outcome.simulated >= 40 * kMillisecond);
    // All that was sent before is there, and the others gave their reports.
    CHECK(recorder.flushed);
    REQUIRE(!recorder.records.empty());
    CHECK(recorder.records.back().time >= 40 * kMillisecond);
    REQUIRE(outcome.nodes.size() == 3);
    CHECK(outcome.nodes[0].json != "");
    CHECK(outcome.nodes[1].json != "");
    CHECK(outcome.nodes[2].json == "");
    CHECK(wall < kSoon);
    CHECK(no_children_left());
}

TEST_CASE("a node that throws in this process is named as well") {
    Run run = with_third("thrower at_us=50000");
    run.options.in_process = true;
    Recorder recorder;
    const Outcome outcome = run(&recorder);
    CHECK(outcome.reason == EndReason::Failed);
    CHECK(outcome.node == "third");
    CHECK_THAT(outcome.text, Catch::Contains("node third stopped") && Catch::Contains("thrown on purpose"));
    CHECK(recorder.flushed);
}

TEST_CASE("kill -9 of a node process ends the run at once") {
    Run run = with_third("idle");
    run.options.duration = kNever;
    run.options.node_command = toy::kNodeCommand;
    int victim = 0;
    run.options.progress = [&victim](const Progress& progress) {
        if (progress.time > 0) kill(victim, SIGKILL);
    };
    Recorder recorder;
    Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
    conductor.add_sink(recorder);
    victim = conductor.process_of("right");
    REQUIRE(victim > 0);
    Outcome outcome;
    const double wall = seconds_of([&] { outcome = conductor.run(); });
    CHECK(outcome.reason == EndReason::Failed);
    CHECK_THAT(outcome.text, Catch::Contains(fmt::format("node right (process {})", victim)) &&
                                 Catch::Contains("was killed by signal 9 (Killed); last simulated time"));
    CHECK(outcome.simulated > 0);
    CHECK(recorder.flushed);
    CHECK(!recorder.records.empty());
    CHECK(wall < kSoon);
    CHECK(no_children_left());
}

TEST_CASE("a node that does not answer is given up after the stall time") {
    Run run = with_third("staller at_us=20000");
    run.options.stall_seconds = kStall;
    Outcome outcome;
    const double wall = seconds_of([&] { outcome = run(); });
    CHECK(outcome.reason == EndReason::Failed);
    CHECK_THAT(outcome.text, Catch::Contains("node third") && Catch::Contains("has not answered for "));
    CHECK(wall >= kStall);
    CHECK(wall < kStall + kSoon);
    CHECK(no_children_left());
}

TEST_CASE("a process that is stopped counts as stalled, others still report") {
    Run run = with_third("idle");
    run.options.duration = kNever;
    run.options.stall_seconds = kStall;
    run.options.node_command = toy::kNodeCommand;
    Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
    kill(conductor.process_of("left"), SIGSTOP);
    const Outcome outcome = conductor.run();
    CHECK(outcome.reason == EndReason::Failed);
    CHECK_THAT(outcome.text, Catch::Contains("node left") && Catch::Contains("has not answered"));
    CHECK(outcome.nodes[1].json != "");
}

TEST_CASE("a process that is no node is refused with its name") {
    Run run = with_third("idle");
    RunOptions options = run.options;
    const auto start = [&](const std::string& mode) {
        options.node_command = {PUCKLOOP_TOY_NODE, mode};
        Conductor conductor(run.nodes, run.links, {}, options, toy::make);
    };
    CHECK_THROWS_WITH(start("garbage"), Catch::Contains("node left") && Catch::Contains("impossible length"));
    CHECK_THROWS_WITH(start("exit"), Catch::Contains("node left") && Catch::Contains("exited with status 5"));
    options.stall_seconds = 0.3;
    CHECK_THROWS_WITH(start("silent"), Catch::Contains("node left") && Catch::Contains("has not answered"));
    options.node_command = {"/nonexistent/program"};
    CHECK_THROWS_AS(Conductor(run.nodes, run.links, {}, options, toy::make), RunError);
    CHECK(no_children_left());
}

TEST_CASE("a signal ends the run, and everything is flushed") {
    for (const bool in_process : {true, false}) {
        Run run = with_third("idle");
        run.options.duration = kNever;
        run.options.in_process = in_process;
        InterruptGuard guard;
        run.options.interrupted = guard.flag();
        Recorder recorder;
        run.options.progress = [](const Progress& progress) {
            if (progress.time > 0) kill(getpid(), SIGINT);
        };
        Outcome outcome;
        const double wall = seconds_of([&] { outcome = run(&recorder); });
        CHECK(outcome.reason == EndReason::Interrupted);
        CHECK(outcome.simulated > 0);
        CHECK(recorder.flushed);
        CHECK(!recorder.records.empty());
        for (const auto& node : outcome.nodes)
            CHECK(node.json != "");
        CHECK(wall < kSoon);
    }
    CHECK(no_children_left());
}

TEST_CASE("node processes die with the conductor, whatever it dies of") {
    int pipe_ends[2];
    REQUIRE(pipe(pipe_ends) == 0);
    const pid_t conductor_process = fork();
    if (conductor_process == 0) {
        Run run = with_third("idle");
        run.options.node_command = toy::kNodeCommand;
        Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
        for (const char* name : {"left", "right", "third"}) {
            const int id = conductor.process_of(name);
            if (write(pipe_ends[1], &id, sizeof id) < 0) _exit(1);
        }
        raise(SIGKILL);
    }
    close(pipe_ends[1]);
    int id = 0;
    std::vector<int> children;
    while (read(pipe_ends[0], &id, sizeof id) == sizeof id)
        children.push_back(id);
    close(pipe_ends[0]);
    waitpid(conductor_process, nullptr, 0);
    REQUIRE(children.size() == 3);
    const auto gone = [](int process) {
        // The tests' init may leave the zombie standing; it runs no more.
        std::ifstream stat(fmt::format("/proc/{}/stat", process));
        std::string number, name, state;
        return !(stat >> number >> name >> state) || state == "Z" || state == "X";
    };
    for (const int child : children) {
        for (int tries = 0; tries < 200 && !gone(child); ++tries)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        CHECK(gone(child));
    }
}
