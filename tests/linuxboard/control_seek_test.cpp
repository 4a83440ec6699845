// The behaviour that looks for a booth by its colour.

#include "linuxboard/control/behaviours/seek.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace puckloop::control;
using Colour = ColouredSpot::Colour;

namespace {

/// The three lights of a booth in a row, at this bearing (rad) and distance (cm), seen from the axis.
std::vector<ColouredSpot> row_of_lights(Colour colour, double bearing, double distance) {
    const double aside = std::atan(2.5 / distance), farther = std::hypot(2.5, distance);
    return {{colour, bearing, distance, 40},
            {colour, bearing + aside, farther, 40},
            {colour, bearing - aside, farther, 40}};
}

/// A robot in the plane before a booth whose lights are at the origin and whose opening looks along +x.
struct Plane {
    double x = 500, y = 120, heading = 3.0;  // mm, rad
    bool lit = true;

    Sensors sensors() const {
        Sensors seen;
        seen.spots.emplace();
        for (const double light : {-25.0, 0.0, 25.0}) {
            // Between the edges of its sides, 95 mm before the lights.
            const bool open = x < 95 || std::abs(light + (y - light) * 95 / x) < 45;
            const double bearing = std::remainder(std::atan2(light - y, -x) - heading, 2 * std::numbers::pi);
            if (lit && x > 30 && open)
                seen.spots->push_back({Colour::Green, bearing, std::hypot(x, y - light) / 10, 20});
        }
        seen.spots->push_back({Colour::Red, 2.0, 40, 30});  // somebody works elsewhere
        const bool inside = x < 120 && std::abs(y) < 30;
        const double gap = std::max(0.0, x - 45);
        if (inside) seen.proximity[2] = seen.proximity[5] = 150;
        if (inside && gap < 10) seen.proximity[0] = seen.proximity[7] = 3000;
        return seen;
    }
    void drive(const Actuators& wheels) {
        const double left = wheels.left_mm_s * 0.1, right = wheels.right_mm_s * 0.1;
        heading += (right - left) / 53;
        x = std::max(x + (left + right) / 2 * std::cos(heading), 46.0);
        y += (left + right) / 2 * std::sin(heading);
    }
};

}  // namespace

TEST_CASE("it wanders while no booth offers anything") {
    Seek seek;
    Sensors nothing;
    nothing.spots.emplace();
    Sensors red = nothing;
    red.spots->push_back({Colour::Red, 0.0, 15, 80});
    for (const Sensors& sensors : {nothing, red}) {
        const Actuators out = seek.step(sensors, 0.0);
        CHECK(out.left_mm_s > 0);
        CHECK(out.left_mm_s == out.right_mm_s);
    }
}

TEST_CASE("it turns to the light, whichever side it is on") {
    for (const double bearing : {-2.0, -0.5, 0.5, 2.0}) {
        Seek seek;
        Sensors seen;
        seen.spots = {{Colour::Red, -bearing, 20, 90}, {Colour::Blue, bearing, 50, 30}};
        seek.step(seen, 0.0);
        const Actuators out = seek.step(seen, 0.1);
        CHECK((out.right_mm_s - out.left_mm_s) * bearing > 0);
    }
}

TEST_CASE("it aims between the lights of one booth") {
    Seek seek;
    Sensors seen;
    seen.spots = {{Colour::Green, 0.2, 30, 40}, {Colour::Green, 0.0, 30, 30}, {Colour::Green, -0.2, 30, 40}};
    seek.step(seen, 0.0);
    const Actuators out = seek.step(seen, 0.1);
    CHECK(out.left_mm_s == Approx(out.right_mm_s).margin(1));
}

TEST_CASE("it drives to a booth, serves while it shines, leaves and turns away") {
    const double aside = GENERATE(120.0, -200.0, 250.0, -310.0);  // up to where one light alone is seen
    CAPTURE(aside);
    Seek seek;
    Plane plane;
    plane.y = aside;
    double entered = -1, nearest = 1e9, farthest_after = 0, turned_after = 0;
    double offset = 0;  // from the axis, at the mouth
    for (double t = 0; t < 60; t += 0.1) {
        const Actuators out = seek.step(plane.sensors(), t);
        if (entered < 0 && plane.x < 60) entered = t;
        if (entered < 0 && plane.x < 130) offset = plane.y;
        if (entered >= 0 && t > entered + 8) plane.lit = false;
        const double before = plane.heading;
        plane.drive(out);
        nearest = std::min(nearest, plane.x);
        if (seek.visits() > 0) {
            farthest_after = std::max(farthest_after, std::hypot(plane.x, plane.y));
            turned_after += std::abs(plane.heading - before);
        }
    }
    CHECK(entered > 0);
    CHECK(std::abs(offset) < 12);
    CHECK(entered < 30);
    CHECK(nearest < 60);
    CHECK(seek.visits() == 1);
    CHECK(farthest_after > 200);
    CHECK(turned_after > 2.5);
}

TEST_CASE("a side that was in its way it avoids the next time") {
    for (const bool on_right : {true, false}) {
        Seek seek;
        double turned = 0;
        bool backed = false;
        for (double t = 0; t < 20 && turned == 0; t += 0.1) {
            Sensors seen;
            seen.spots = row_of_lights(Colour::Green, 0.0, 15);
            if (t > 1) seen.proximity[on_right ? 1 : 6] = 1500;
            const Actuators out = seek.step(seen, t);
            backed |= out.left_mm_s < 0 && out.right_mm_s < 0;
            if (backed && out.left_mm_s * out.right_mm_s < 0) turned = out.right_mm_s - out.left_mm_s;
        }
        CHECK(backed);
        CHECK((on_right ? turned : -turned) > 0);
        CHECK(seek.visits() == 0);
    }
}
