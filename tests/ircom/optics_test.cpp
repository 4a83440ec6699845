// How much light arrives: the measured curve between robots, lobes, shade.

#include "physics/ircom/optics.h"

#include "base/random.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::physics;

namespace {

/// The brightest sensor of a robot at (distance, 0) that looks at the origin, of another there whose front is
/// turned away by `turn`.
double brightest(double distance, double turn = 0.0) {
    const Parameters p;
    const auto parts = ircom_parts(p.proximity);
    double best = 0.0;
    for (const IrcomPart& receiver : parts) {
        double sum = 0.0;
        for (const IrcomPart& emitter : parts)
            sum += ircom_counts(in_world(emitter, 0, 0, std::cos(turn), std::sin(turn)),
                                in_world(receiver, distance, 0, -1, 0), p.ircom);
        best = std::max(best, sum);
    }
    return best;
}

}  // namespace

TEST_CASE("two robots face to face show the amplitudes that IRcom's authors measured") {
    // e-puck fact sheet 3.10: cm between centres, counts.
    const std::pair<double, double> measured[] = {{7.5, 3533.8}, {8, 2103.5}, {9, 701.8},
                                                  {10, 375.8},   {12, 167.4}, {14.5, 69.4},
                                                  {17, 35.0},    {20, 20.0},  {22, 14.6}};
    for (const auto& [centimetres, counts] : measured) {
        CAPTURE(centimetres);
        CHECK(brightest(centimetres / 100) == Approx(counts).epsilon(0.03));
    }
    double before = 1e9;
    for (double metres = 0.002; metres < 0.4; metres += 0.001) {
        CHECK(ircom_level(metres) <= before);
        before = ircom_level(metres);
    }
}

TEST_CASE("light falls with the angle at either end, and nothing passes behind") {
    const IrcomParameters p = Parameters().ircom;
    RandomStream random(5, "angles");
    for (int i = 0; i < 200; ++i) {
        const double way = 0.01 + 0.3 * random.uniform();
        const double at = 7 * random.uniform();
        const double out = 3 * (random.uniform() - 0.5), in = 3 * (random.uniform() - 0.5);
        const IrcomPart from{0.2, -0.1, std::cos(at + out), std::sin(at + out)};
        const IrcomPart to{0.2 + way * std::cos(at), -0.1 + way * std::sin(at), -std::cos(at + in),
                           -std::sin(at + in)};
        const double expected = ircom_level(way) * std::pow(std::cos(out), p.emitter_exponent) *
                                std::pow(std::cos(in), p.receiver_exponent);
        CHECK(ircom_counts(from, to, p) == Approx(expected));
        const IrcomPart away{from.x, from.y, -from.dx, -from.dy};
        CHECK(ircom_counts(away, to, p) == 0.0);
        CHECK(ircom_counts(from, {to.x, to.y, -to.dx, -to.dy}, p) == 0.0);
    }
    CHECK(ircom_counts({0, 0, 1, 0}, {p.reach + 0.001, 0, -1, 0}, p) == 0.0);
    // All round a robot there is light; it is strongest where most of its diodes are.
    const double front = brightest(0.12);
    for (const double turn : {30.0, 60.0, 90.0, 135.0, 180.0}) {
        const double light = brightest(0.12, turn * std::numbers::pi / 180);
        CHECK(light > 0.3 * front);
        CHECK(light < 1.2 * front);
    }
}

TEST_CASE("what stands between shades") {
    const IrcomPart from{0, 0, 1, 0}, to{0.2, 0.0, -1, 0};
    const Shape post = circle_shape(0.1, 0.01, 0.011, 0.1, 1),
                beside = circle_shape(0.1, 0.02, 0.019, 0.1, 1),
                behind = circle_shape(0.25, 0.0, 0.04, 0.1, 1);
    const Shape* const one[] = {&beside, &behind};
    CHECK_FALSE(ircom_shaded(from, to, one));
    const Shape* const two[] = {&beside, &post};
    CHECK(ircom_shaded(from, to, two));
}
