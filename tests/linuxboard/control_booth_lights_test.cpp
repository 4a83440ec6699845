// The lights of a booth as one: where they are, and which way the booth opens.

#include "base/random.h"
#include "linuxboard/control/behaviours/booth_lights.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::control;
using Colour = ColouredSpot::Colour;

namespace {

struct Point {
    double x = 0, y = 0;
};

ColouredSpot seen_from_origin(Colour colour, Point light, int area) {
    return {colour, std::atan2(light.y, light.x), std::hypot(light.x, light.y), area};
}

}  // namespace

TEST_CASE("the row of lights shows which way the booth opens, from wherever it is seen") {
    RandomStream random(71, "rows");
    for (int i = 0; i < 200; ++i) {
        const double distance = 15 + 30 * random.uniform();
        const double bearing = 2 * std::numbers::pi * random.uniform();
        const double askew = 1.2 * (random.uniform() - 0.5);
        const Point middle{distance * std::cos(bearing), distance * std::sin(bearing)};
        const double axis = bearing + std::numbers::pi + askew;  // out of the opening
        std::vector<ColouredSpot> spots;
        const std::size_t left_out = random.below(4);  // 3: all are seen
        for (std::size_t k = 0; k < 3; ++k) {
            const double along = 2.5 * (static_cast<double>(k) - 1);
            if (k != left_out)
                spots.push_back(seen_from_origin(
                    Colour::Blue, {middle.x - along * std::sin(axis), middle.y + along * std::cos(axis)},
                    20));
        }
        CAPTURE(distance, bearing, askew, left_out);
        const auto booths = booths_of(spots);
        REQUIRE(booths.size() == 1);
        REQUIRE(booths[0].askew);
        // Exact about the middle of those that are seen, which is up to 1.25 cm beside the booth's.
        CHECK(std::abs(*booths[0].askew - askew) < 1.3 / distance + 1e-9);
        if (left_out == 3) CHECK(*booths[0].askew == Approx(askew).margin(1e-9));
        // The point on the axis as far before the lights as the robot is: it lies at a right angle to the
        // half.
        const ColouredSpot& lights = booths[0].middle;
        const double toward = bearing_of_axis(lights, *booths[0].askew, 0.5);
        const double x = lights.distance_cm * (1 - 0.5 * std::cos(*booths[0].askew));
        const double y = -0.5 * lights.distance_cm * std::sin(*booths[0].askew);
        CHECK(std::remainder(toward - lights.bearing - std::atan2(y, x), 2 * std::numbers::pi) ==
              Approx(0).margin(1e-9));
    }
}

TEST_CASE("one light shows no direction, and lights of other booths and colours are others'") {
    const std::vector<ColouredSpot> spots{{Colour::Green, 0.1, 30, 50},
                                          {Colour::Red, 0.12, 30, 40},
                                          {Colour::Green, 1.5, 30, 30},
                                          {Colour::Green, 1.58, 30.5, 20}};
    const auto booths = booths_of(spots);
    REQUIRE(booths.size() == 3);
    CHECK_FALSE(booths[0].askew);
    CHECK(booths[0].middle.bearing == Approx(0.1));
    CHECK(booths[1].middle.colour == Colour::Red);
    CHECK(booths[2].askew);
    CHECK(booths[2].middle.area == 50);
    CHECK(booths[2].middle.bearing > 1.5);
    CHECK(booths[2].middle.bearing < 1.58);
    CHECK(booths_of({}).empty());
}
