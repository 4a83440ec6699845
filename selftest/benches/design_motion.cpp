#include "selftest/benches/design_motion.h"

#include "physics/description/robot_constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kCommandEvery = 0.1;  // s between two commands of the host
constexpr double kDesignAxle = physics::kAxleLength;
constexpr double kLoad = 0.2;  // kg, in one line
constexpr double kRest = 0.5;  // s before and after

/// A manoeuvre of constant speeds.
struct Leg {
    double seconds, left, right;
};

/// Commands sent again every 100 ms, as a host does.
MotionScript script_of(const std::vector<Leg>& legs, double heading) {
    MotionScript script;
    script.heading = heading;
    double t = 0.0;
    for (const Leg& leg : legs) {
        const auto sends = std::max(1L, std::lround(leg.seconds / kCommandEvery));
        for (long k = 0; k < sends; ++k)
            script.commands.push_back({t + static_cast<double>(k) * kCommandEvery, leg.left, leg.right});
        t += static_cast<double>(sends) * kCommandEvery;
    }
    script.seconds = t;
    return script;
}

std::vector<Leg> rested(std::vector<Leg> legs) {
    legs.insert(legs.begin(), {kRest, 0, 0});
    legs.push_back({kRest, 0, 0});
    return legs;
}

std::vector<Leg> square(double sense) {
    constexpr double kSpeed = 500, kTurn = 250, kSide = 0.15;
    std::vector<Leg> legs;
    const double side = kSide / (kSpeed * physics::kMetresPerStep);
    const double corner = std::numbers::pi / 2 * kDesignAxle / 2 / (kTurn * physics::kMetresPerStep);
    for (int k = 0; k < 4; ++k) {
        legs.push_back({side, kSpeed, kSpeed});
        legs.push_back({corner, -sense * kTurn, sense * kTurn});
    }
    return legs;
}

std::vector<Leg> hops() {
    std::vector<Leg> legs;
    for (int k = 0; k < 6; ++k) {
        legs.push_back({0.7, 800, 800});
        legs.push_back({0.6, 0, 0});
    }
    return legs;
}

std::vector<Leg> reversals() {
    std::vector<Leg> legs;
    for (int k = 0; k < 3; ++k) {
        legs.push_back({1.2, 400, 400});
        legs.push_back({1.2, -400, -400});
    }
    return legs;
}

/// Through zero in small steps.
std::vector<Leg> crawl() {
    std::vector<Leg> legs;
    for (const double speed : {-120.0, -70.0, -42.0, -25.0, -15.0, 11.0, 20.0, 33.0, 55.0, 90.0})
        legs.push_back({1.2, speed, speed});
    return legs;
}

std::vector<Leg> free_drive(RandomStream& random) {
    std::vector<Leg> legs;
    for (int k = 0; k < 10; ++k) {
        const double base = std::round(-300 + 1000 * random.uniform());
        const double turn = std::round(-200 + 400 * random.uniform());
        const double least = k % 4 == 3 ? 0.08 : 1.0;  // some of it slowly
        legs.push_back(
            {0.4 + random.uniform(), std::round(least * (base - turn)), std::round(least * (base + turn))});
    }
    return legs;
}

}  // namespace

std::vector<PlannedDrive> planned_drives(RandomStream& random, bool one_circle) {
    std::vector<PlannedDrive> plan;
    for (int repeat = 0; repeat < 2; ++repeat) {
        const auto add = [&](const char* path, const char* sense, const std::vector<Leg>& legs) {
            const double heading = 2 * std::numbers::pi * random.uniform() - std::numbers::pi;
            plan.push_back({path, sense, script_of(rested(legs), heading)});
        };
        if (one_circle) {
            for (int k = 0; k < 4; ++k)
                add("circle", "ccw", {{24, 250, 450}});
            continue;
        }
        add("line", "forward", {{5, 300, 300}});
        add("line", "forward", {{5, 450, 450}});
        plan.back().script.load = kLoad;
        add("line", "forward", {{15, 850, 850}});
        add("line", "backward", {{5, -850, -850}});
        add("spin", "ccw", {{5, -300, 300}});
        add("spin", "cw", {{5, 600, -600}});
        add("square", "ccw", square(1));
        add("square", "cw", square(-1));
        add("circle", "ccw", {{15, 450, 800}});
        add("circle", "cw", {{15, 800, 450}});
        add("hops", "forward", hops());
        add("reversals", "both", reversals());
        add("crawl", "both", crawl());
        add("free", "both", free_drive(random));
    }
    return plan;
}

}  // namespace puckloop::gap::selftest
