#include "cosim/schedule/workers.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>
#include <vector>

using puckloop::cosim::Workers;

namespace {
void take_all(Workers& workers, std::vector<std::size_t>& done) {
    while (workers.under_way() > 0) {
        if (!workers.do_one()) workers.wait();
        workers.take_done(done);
    }
}
}  // namespace

TEST_CASE("every piece is done exactly once, round after round") {
    for (const unsigned helpers : {0u, 1u, 3u}) {
        std::vector<int> times(8, 0);
        Workers workers(helpers, times.size(), [&](std::size_t piece) { ++times[piece]; });
        std::vector<std::size_t> done;
        for (std::size_t round = 0; round < 3000; ++round) {
            const std::size_t count = round % 9;
            times.assign(8, 0);
            done.clear();
            for (std::size_t piece = 0; piece < count; ++piece)
                workers.submit(piece, round % 2 == 0);
            take_all(workers, done);
            REQUIRE(done.size() == count);
            for (std::size_t piece = 0; piece < times.size(); ++piece)
                REQUIRE(times[piece] == (piece < count ? 1 : 0));
        }
    }
}

TEST_CASE("pieces come back one by one and go out again, in any order") {
    std::vector<int> times(5, 0);
    Workers workers(2, times.size(), [&](std::size_t piece) {
        if (piece == 3) std::this_thread::sleep_for(std::chrono::microseconds(300));
        ++times[piece];
    });
    std::vector<std::size_t> done;
    for (std::size_t piece = 0; piece < times.size(); ++piece)
        workers.submit(piece, true);
    for (int replies = 0; replies < 20000;) {
        if (!workers.do_one()) workers.wait();
        done.clear();
        workers.take_done(done);
        for (const std::size_t piece : done) {
            ++replies;
            workers.submit(piece, false);
        }
    }
    take_all(workers, done);
    int all = 0;
    for (const int count : times)
        all += count;
    CHECK(all >= 20000 + 5);
    CHECK(all < 20000 + 10);
}

TEST_CASE("helpers that went to sleep come back") {
    std::vector<int> times(8, 0);
    Workers workers(2, times.size(), [&](std::size_t piece) {
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        ++times[piece];
    });
    std::vector<std::size_t> done;
    for (int round = 0; round < 5; ++round) {
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
        for (std::size_t piece = 0; piece < times.size(); ++piece)
            workers.submit(piece, true);
        if (round % 2 == 0) {
            take_all(workers, done);
        } else {
            while (workers.under_way() > 0) {  // by the helpers alone
                workers.wait();
                workers.take_done(done);
            }
        }
    }
    CHECK(times == std::vector<int>(8, 5));
}

TEST_CASE("stopped, nobody works any more") {
    for (int round = 0; round < 50; ++round) {
        std::vector<int> times(8, 0);
        Workers workers(2, times.size(), [&](std::size_t piece) {
            std::this_thread::sleep_for(std::chrono::microseconds(50));
            ++times[piece];
        });
        for (std::size_t piece = 0; piece < times.size(); ++piece)
            workers.submit(piece, true);
        std::this_thread::sleep_for(std::chrono::microseconds(20 * round % 300));
        workers.stop();
        CHECK(workers.under_way() == 0);
        const std::vector<int> now = times;
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        CHECK(times == now);
    }
}
