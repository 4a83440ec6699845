#include "cosim/core/clock.h"

#include <catch2/catch.hpp>

using namespace puckloop::cosim;

TEST_CASE("cycles and times agree both ways") {
    ClockDomain clock(14'745'600.0);
    CHECK(clock.time_of(14'745'600) == kSecond);
    for (std::uint64_t cycle : {0u, 1u, 2u, 128u, 1'000'003u, 4'000'000'000u}) {
        const Time start = clock.time_of(cycle);
        CHECK(clock.first_cycle_at(start) == cycle);
        CHECK(clock.first_cycle_at(start + 1) == cycle + 1);
    }
}

TEST_CASE("drift shifts time by its parts per million") {
    ClockDomain clock(1'000'000.0, 100.0);
    CHECK(clock.time_of(1'000'100) == kSecond);
}

TEST_CASE("a change of rate is seamless") {
    ClockDomain clock(1'000'000.0);
    clock.change_rate(500'000, 2'000'000.0);
    CHECK(clock.time_of(500'000) == kSecond / 2);
    CHECK(clock.time_of(1'500'000) == kSecond);
    CHECK(clock.first_cycle_at(kSecond) == 1'500'000);
    clock.change_rate(1'500'000, 250'000.0);
    CHECK(clock.time_of(250'000) == kSecond / 4);  // cycles of earlier rates keep their times
    CHECK(clock.time_of(1'000'000) == kSecond * 3 / 4);
    CHECK(clock.time_of(1'750'000) == 2 * kSecond);
}
