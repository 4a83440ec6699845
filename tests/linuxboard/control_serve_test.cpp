// The behaviour that serves at a booth, on a track of one dimension.

#include "linuxboard/control/behaviours/serve.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop::control;

namespace {

/// A booth straight ahead: `gap` is between the robot's front and the booth's back, mm; beside it are sides
/// for the last 70 mm.
struct Track {
    double gap = 250;
    bool sides = true;
    Sensors sensors() const {
        Sensors seen;
        const double ahead = std::clamp(4000 - 350 * gap, 0.0, 4000.0);
        seen.proximity[0] = seen.proximity[7] = std::max(ahead, gap < 45 ? 150.0 : 0.0);
        if (sides && gap < 70) seen.proximity[2] = seen.proximity[5] = 150;
        return seen;
    }
    void drive(const Actuators& wheels) {
        gap = std::max(gap - (wheels.left_mm_s + wheels.right_mm_s) / 2 * 0.1, 0.5);
    }
};

}  // namespace

TEST_CASE("it drives in, stays, backs out and comes again") {
    Serve serve;
    Track track;
    double inside = 0, farthest = 0;
    for (double t = 0; t < 60; t += 0.1) {
        const Actuators out = serve.step(track.sensors(), t);
        if (out.body_led) {
            CHECK(out.left_mm_s == 0);
            CHECK(track.gap < 15);
            inside += 0.1;
        }
        track.drive(out);
        if (serve.visits() > 0) farthest = std::max(farthest, track.gap);
    }
    CHECK(serve.visits() >= 2);
    CHECK(inside >= 16);
    CHECK(farthest > 150);  // wholly out of the booth
}

TEST_CASE("before something that is no booth it stops and goes back") {
    Serve serve;
    Track wall;
    wall.sides = false;
    bool back = false;
    for (double t = 0; t < 10; t += 0.1) {
        const Actuators out = serve.step(wall.sensors(), t);
        back |= out.left_mm_s < 0;
        wall.drive(out);
        CHECK(wall.gap > 5);
    }
    CHECK(back);
    CHECK(serve.visits() == 0);
}

TEST_CASE("it keeps to the middle") {
    Serve serve;
    Sensors seen;
    seen.proximity[6] = 400;  // the left edge of the booth's mouth is nearer
    seen.proximity[1] = 60;
    serve.step(Sensors{}, 0);
    const Actuators out = serve.step(seen, 0.1);
    CHECK(out.left_mm_s > out.right_mm_s);
}

TEST_CASE("with a camera it waits for a booth that shines, and stays as long as it does") {
    using Colour = ColouredSpot::Colour;
    Serve serve;
    Sensors seen;
    seen.spots.emplace();
    CHECK(serve.step(seen, 0).left_mm_s == 0);
    seen.spots = {{Colour::Red, 0.0, 30, 50}};  // somebody works there
    CHECK(serve.step(seen, 0.1).left_mm_s == 0);
    seen.spots = {{Colour::Red, 0.0, 30, 50}, {Colour::Blue, 0.5, 30, 40}};
    const Actuators turn = serve.step(seen, 0.2);
    CHECK(turn.right_mm_s > turn.left_mm_s);
    seen.spots = {{Colour::Green, 2.5, 30, 50}};  // behind
    CHECK(serve.step(seen, 0.3).left_mm_s == 0);

    Track track;
    double dark_at = 40, left_at = 0;
    for (double t = 1; t < 60 && left_at == 0; t += 0.1) {
        Sensors sensors = track.sensors();
        sensors.spots.emplace();
        if (t < dark_at) sensors.spots->push_back({Colour::Green, 0.0, track.gap / 10 + 4, 50});
        const Actuators out = serve.step(sensors, t);
        if (serve.visits() == 1 && out.left_mm_s < 0) left_at = t;
        track.drive(out);
    }
    CHECK(serve.visits() == 1);
    CHECK(left_at == Approx(dark_at + 0.8).margin(0.25));
}
