#include "physics/robot/delay_line.h"

#include <catch2/catch.hpp>

using namespace puckloop::physics;

namespace {

/// What comes out of a line of `seconds` that is fed 100, 101, 102, ... once a step.
std::vector<double> out_of(double seconds, int steps) {
    DelayLine<1> line(seconds);
    std::vector<double> out;
    for (int k = 0; k < steps; ++k)
        out.push_back(line.next({100.0 + k})[0]);
    return out;
}

}  // namespace

TEST_CASE("a delay line gives what was there before, and the first value until it has run full") {
    CHECK_FALSE(DelayLine<1>(0.0).delays());
    CHECK(out_of(0.0, 3) == std::vector<double>{100, 101, 102});
    const auto late = out_of(0.005, 20);
    for (int k = 0; k < 20; ++k)
        CHECK(late[static_cast<std::size_t>(k)] == Approx(100 + std::max(k - 5, 0)));
}

TEST_CASE("between two steps a delay line goes straight") {
    const auto late = out_of(0.0025, 12);
    CHECK(late[2] == Approx(100));
    for (std::size_t k = 3; k < 12; ++k)
        CHECK(late[k] == Approx(100.0 + static_cast<double>(k) - 2.5));
    const auto least = out_of(0.0002, 5);
    for (std::size_t k = 1; k < 5; ++k)
        CHECK(least[k] == Approx(100.0 + static_cast<double>(k) - 0.2));
}
