// A node process that writes anything into the memory it shares with the conductor: nothing hangs, nothing
// crashes, and whoever is blamed is that node.

#include "toy_run.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <chrono>

#include <sys/wait.h>

using namespace puckloop;
using namespace puckloop::cosim;

TEST_CASE("a node process that writes nonsense into its ring is blamed for it, by name") {
    for (int seed = 1; seed <= 25; ++seed) {
        toy::Run run{{{"left", "echo first=1"}, {"right", "echo"}, {"third", "idle"}},
                     {toy::uart("wire", {"left", "uart0"}, {"right", "uart0"})}};
        run.options.duration = kNever;
        run.options.stall_seconds = 3.0;  // long enough for the others on a busy machine
        run.options.node_command = {PUCKLOOP_TOY_NODE, "node", "right", std::to_string(seed)};
        INFO("seed " << seed);
        const auto begun = std::chrono::steady_clock::now();
        try {
            Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
            const Outcome outcome = conductor.run();
            CHECK(outcome.reason == EndReason::Failed);
            CHECK(outcome.node == "right");
            CHECK_THAT(outcome.text, Catch::Contains("node right"));
        } catch (const std::exception& error) {
            CHECK_THAT(error.what(), Catch::Contains("node right"));
        }
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begun;
        CHECK(wall.count() < 20.0);
        CHECK((waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD));
    }
}

TEST_CASE("nonsense in what all processes share costs time at most") {
    toy::Run run = toy::random_chatter(5, 4);
    run.options.duration = 20 * kMillisecond;
    const Outcome plain = run();
    REQUIRE(plain.reason == EndReason::Duration);
    for (int seed = 1; seed <= 6; ++seed) {
        INFO("seed " << seed);
        RunOptions options = run.options;
        options.in_process = false;
        options.node_command = {PUCKLOOP_TOY_NODE, "node", run.nodes[1].name, std::to_string(seed), "all"};
        Conductor conductor(run.nodes, run.links, {}, options, toy::make);
        const Outcome outcome = conductor.run();
        CHECK(outcome.reason == EndReason::Duration);
        CHECK(outcome.trace_sha256 == plain.trace_sha256);
    }
}
