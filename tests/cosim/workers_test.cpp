#include "cosim/schedule/workers.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>
#include <vector>

using puckloop::cosim::Workers;

TEST_CASE("every piece is done exactly once, round after round") {
    for (const unsigned helpers : {0u, 1u, 3u}) {
        Workers workers(helpers);
        for (std::size_t round = 0; round < 3000; ++round) {
            const std::size_t count = round % 9;
            std::vector<int> times(count, 0);
            workers.run(count, [&](std::size_t piece) { ++times[piece]; });
            REQUIRE(times == std::vector<int>(count, 1));
        }
    }
}

TEST_CASE("helpers that went to sleep come back") {
    Workers workers(2);
    std::vector<int> times(8, 0);
    for (int round = 0; round < 5; ++round) {
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
        workers.run(times.size(), [&](std::size_t piece) {
            std::this_thread::sleep_for(std::chrono::microseconds(200));
            ++times[piece];
        });
    }
    CHECK(times == std::vector<int>(8, 5));
}
