// The lists of what is near, and the plan's short cuts for rays and distances, against looking at everything.

#include "base/random.h"
#include "physics/dynamics/neighbours.h"
#include "tests/physics/random_world.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

Shape random_shape(RandomStream& chance) {
    const double x = between(chance, -1, 1), y = between(chance, -1, 1);
    if (chance.below(2) == 0) return circle_shape(x, y, between(chance, .01, .3), 0.1, 1.0);
    return box_shape(x, y, between(chance, -4, 4), between(chance, .01, 2), between(chance, .01, .3), .1,
                     1.0);
}

}  // namespace

TEST_CASE("lists hold all that is within reach, wherever things went meanwhile", "[increments]") {
    constexpr double kSlack = 0.05;
    RandomStream chance(5, "neighbours");
    for (int round = 0; round < 60; ++round) {
        std::vector<Shape> fixed;
        std::vector<const Shape*> pointers;
        for (int i = 0; i < 12; ++i)
            fixed.push_back(random_shape(chance));
        for (const Shape& shape : fixed)
            pointers.push_back(&shape);
        std::vector<Disc> discs;
        for (int i = 0; i < 25; ++i)
            discs.push_back({between(chance, -1, 1), between(chance, -1, 1), between(chance, .01, .1)});
        std::vector<double> reach(15);
        for (double& one : reach)
            one = between(chance, .02, .4);
        Neighbours near(kSlack);
        const auto at = [&](std::size_t i) { return discs[i]; };
        REQUIRE_FALSE(near.hold(discs.size(), at));
        near.make(discs, reach, pointers);
        REQUIRE(near.hold(discs.size(), at));
        int held = 0;
        for (; near.hold(discs.size(), at); ++held) {
            for (std::size_t i = 0; i < reach.size(); ++i) {
                const auto in = [](std::span<const std::uint32_t> list, std::size_t index) {
                    return std::find(list.begin(), list.end(), index) != list.end();
                };
                REQUIRE(std::is_sorted(near.fixed(i).begin(), near.fixed(i).end()));
                REQUIRE(std::is_sorted(near.moving(i).begin(), near.moving(i).end()));
                REQUIRE_FALSE(in(near.moving(i), i));
                for (std::size_t k = 0; k < fixed.size(); ++k)
                    if (touch(fixed[k], discs[i].x, discs[i].y, reach[i]).depth >= 0.0)
                        REQUIRE(in(near.fixed(i), k));
                for (std::size_t k = 0; k < discs.size(); ++k)
                    if (k != i && std::hypot(discs[k].x - discs[i].x, discs[k].y - discs[i].y) <=
                                      reach[i] + discs[k].radius)
                        REQUIRE(in(near.moving(i), k));
            }
            for (Disc& disc : discs) {
                disc.x += between(chance, -.01, .01);
                disc.y += between(chance, -.01, .01);
            }
        }
        CHECK(held > 1);
        REQUIRE_FALSE(near.hold(discs.size() - 1, at));
        near.forget();
        REQUIRE_FALSE(near.hold(discs.size(), at));
    }
}

TEST_CASE("a ray that ends finds what the whole line finds before its end", "[increments]") {
    RandomStream chance(6, "rays");
    int found = 0;
    for (int i = 0; i < 300'000; ++i) {
        const Shape shape = random_shape(chance);
        const double x = between(chance, -1.5, 1.5), y = between(chance, -1.5, 1.5);
        // Along the axes of a box as well, where a direction is 0 or nearly so.
        const double angle = chance.below(4) == 0
                                 ? std::atan2(shape.sine, shape.cosine) +
                                       static_cast<double>(chance.below(4)) * std::numbers::pi / 2
                                 : between(chance, -4, 4);
        const double limit = between(chance, 0, 1);
        auto whole = chord(shape, x, y, std::cos(angle), std::sin(angle));
        if (whole && (whole->out < 0.0 || whole->in >= limit)) whole.reset();
        const auto ray = chord_before(shape, x, y, std::cos(angle), std::sin(angle), limit);
        REQUIRE(ray.has_value() == whole.has_value());
        if (!ray) continue;
        ++found;
        REQUIRE(ray->in == whole->in);
        REQUIRE(ray->out == whole->out);
        REQUIRE(ray->cosine == whole->cosine);
    }
    CHECK(found > 10'000);
}

TEST_CASE("within a reach is what touches a circle of that radius", "[increments]") {
    RandomStream chance(7, "within");
    for (int i = 0; i < 300'000; ++i) {
        const Shape shape = random_shape(chance);
        const double x = between(chance, -1.5, 1.5), y = between(chance, -1.5, 1.5);
        const double reach = between(chance, 0.001, 1);
        const double depth = touch(shape, x, y, reach).depth;
        if (std::abs(depth) < 1e-9) continue;  // on the edge itself either is right
        REQUIRE(within(shape, x, y, reach) == (depth > 0.0));
    }
}
