// Plane geometry: rays, touches, overlaps, polygons.

#include "physics/description/plan.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop::physics;

TEST_CASE("a ray meets a turned box and a circle where it must") {
    const double quarter = std::numbers::pi / 4;
    const Shape box = box_shape(1, 0, quarter, 0.2, 0.2, 0.1, 1);
    const auto hit = chord(box, 0, 0, 1, 0);
    REQUIRE(hit);
    CHECK(hit->in == Approx(1 - 0.1 * std::sqrt(2.0)));
    CHECK(hit->out == Approx(1 + 0.1 * std::sqrt(2.0)));
    CHECK(hit->cosine == Approx(std::sqrt(0.5)));
    CHECK_FALSE(chord(box, 0, 0.15, 1, 0));
    const Shape disc = circle_shape(0, 2, 0.5, 0.1, 1);
    const auto centre = chord(disc, 0, 0, 0, 1);
    REQUIRE(centre);
    CHECK(centre->in == Approx(1.5));
    CHECK(centre->cosine == Approx(1));
    const auto side = chord(disc, 0.3, 0, 0, 1);
    REQUIRE(side);
    CHECK(side->in == Approx(1.6));
    CHECK(side->cosine == Approx(0.8));
    const auto behind = chord(disc, 0, 4, 0, 1);
    REQUIRE(behind);
    CHECK(behind->out < 0);
}

TEST_CASE("a circle touches faces, corners and the inside of a box") {
    const Shape box = box_shape(0, 0, 0, 0.4, 0.2, 0.1, 1);
    const Touch face = touch(box, 0.05, 0.13, 0.05);
    CHECK(face.depth == Approx(0.02));
    CHECK(face.normal_y == Approx(1));
    CHECK(face.y == Approx(0.1));
    const Touch corner = touch(box, 0.23, 0.14, 0.05);
    CHECK(corner.depth == Approx(0.0).margin(1e-12));
    CHECK(corner.normal_x == Approx(0.6));
    const Touch within = touch(box, 0.19, 0, 0.05);
    CHECK(within.depth == Approx(0.06));
    CHECK(within.normal_x == Approx(1));
}

TEST_CASE("overlaps of boxes need all four axes") {
    const Shape a = box_shape(0, 0, 0, 0.2, 0.2, 0.1, 1);
    // Its corner reaches 0.0707 m towards `a`, whose face is 0.1 m out.
    CHECK_FALSE(overlap(a, box_shape(0.172, 0, std::numbers::pi / 4, 0.1, 0.1, 0.1, 1)));
    CHECK(overlap(a, box_shape(0.169, 0, std::numbers::pi / 4, 0.1, 0.1, 0.1, 1)));
    CHECK(overlap(a, box_shape(0.15, 0.15, std::numbers::pi / 4, 0.2, 0.02, 0.1, 1)));         // points at it
    CHECK_FALSE(overlap(a, box_shape(0.15, 0.15, -std::numbers::pi / 4, 0.2, 0.02, 0.1, 1)));  // passes by
    CHECK(overlap(a, circle_shape(0.13, 0, 0.031, 0.1, 1)));
    CHECK_FALSE(overlap(a, circle_shape(0.13, 0, 0.029, 0.1, 1)));
}

TEST_CASE("an L-shaped arena has walls outside, none across the inside corner") {
    Arena arena;
    arena.corners = {{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}};
    CHECK(signed_area(arena.corners) == Approx(1.5));
    CHECK(inside(arena.corners, 0.25, 0.75));
    CHECK_FALSE(inside(arena.corners, 0.75, 0.75));
    CHECK(edge_distance(arena.corners, 0.4, 0.4) == Approx(std::sqrt(0.02)));
    const auto clear = [&](double x, double y) {
        for (const auto& wall : arena_walls(arena))
            if (touch(wall, x, y, 0.0).depth > 0) return false;
        return true;
    };
    for (double x = 0.005; x < 1; x += 0.01)
        for (double y = 0.005; y < 1; y += 0.01)
            if (inside(arena.corners, x, y)) CHECK(clear(x, y));
    CHECK_FALSE(clear(1.005, 0.25));
    CHECK_FALSE(clear(-0.005, -0.005));  // corners are closed
    CHECK_FALSE(clear(0.505, 0.7));
}
