#include "cosim/schedule/bounds.h"

#include "base/random.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop::cosim;

TEST_CASE("an EOT and a latency bound the receiver") {
    Bounds bounds;
    const std::vector<Channel> channels{{0, 1, 100, 5}};
    const std::vector<Time> pending{kNever, kNever};
    bounds.compute(channels, pending);
    CHECK(bounds.limit(1) == 100);
    CHECK(bounds.limit(0) == kNever);
    CHECK(bounds.root(1) == 0);
    CHECK(bounds.root(0) == kNobody);
    CHECK(bounds.floor() == 100);
}

TEST_CASE("a pending message shortens what its node may answer, not how far it may go") {
    Bounds bounds;
    const std::vector<Channel> channels{{0, 1, 100, 5}, {1, 0, 300, 7}};
    const std::vector<Time> pending{20, kNever};
    bounds.compute(channels, pending);
    CHECK(bounds.limit(1) == 25);      // 0 answers its message
    CHECK(bounds.limit(0) == 25 + 7);  // and 1 the answer
    CHECK(bounds.root(1) == 0);
    CHECK(bounds.root(0) == 0);
}

TEST_CASE("zero-lookahead chains of any length come out exactly") {
    constexpr std::size_t kNodes = 200;
    std::vector<Channel> channels;
    // Worst order for a relaxation that goes through the list once.
    for (std::size_t n = kNodes - 1; n > 0; --n)
        channels.push_back({n - 1, n, kNever, 0});
    std::vector<Time> pending(kNodes, kNever);
    pending[0] = 42;
    Bounds bounds;
    bounds.compute(channels, pending);
    CHECK(bounds.limit(kNodes - 1) == 42);
    CHECK(bounds.root(kNodes - 1) == 0);
}

TEST_CASE("bounds on random graphs equal the shortest of all paths") {
    puckloop::RandomStream random(5, "bounds");
    for (int round = 0; round < 300; ++round) {
        const std::size_t count = 2 + random.below(5);
        std::vector<Channel> channels;
        for (std::size_t c = 0; c < 2 * count; ++c)
            channels.push_back({random.below(count), random.below(count),
                                random.below(3) == 0 ? kNever : static_cast<Time>(random.below(50)),
                                static_cast<Time>(random.below(3) == 0 ? 0 : random.below(20))});
        std::vector<Time> pending(count, kNever);
        for (Time& time : pending)
            if (random.below(3) == 0) time = static_cast<Time>(random.below(60));
        // All walks of up to `count` channels, from every EOT and every pending message.
        std::vector<Time> earliest = pending, limit(count, kNever);
        std::vector<Time> walk = pending;
        for (std::size_t length = 0; length <= count; ++length) {
            std::vector<Time> next(count, kNever);
            for (const Channel& c : channels)
                next[c.to] =
                    std::min({next[c.to], later(walk[c.from], c.lookahead), length == 0 ? c.base : kNever});
            for (std::size_t n = 0; n < count; ++n) {
                limit[n] = std::min(limit[n], next[n]);
                earliest[n] = std::min(earliest[n], next[n]);
            }
            walk = next;
        }
        Bounds bounds;
        bounds.compute(channels, pending);
        for (std::size_t n = 0; n < count; ++n)
            REQUIRE(bounds.limit(n) == limit[n]);
    }
}
