// Finite-state machines as text, and what their modules do.

#include "linuxboard/control/behaviours/machine.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>

using namespace puckloop::control;
using Catch::Contains;

namespace {

/// A state of one kind that is never left.
StateMachine only(const std::string& state, std::uint32_t seed = 1) {
    return {parse_machine("--nstates 1 " + state), seed};
}

Neighbour at(double bearing, double range_cm) {
    return {.id = 7, .bearing = bearing, .range_cm = range_cm};
}

/// How often of 4,000 robots left the first state, in the first step in which they may.
double share_left(const std::string& condition, const Sensors& sensors) {
    constexpr int kRobots = 4000;
    int left = 0;
    for (int seed = 0; seed < kRobots; ++seed) {
        StateMachine machine(
            parse_machine("--nstates 2 --s0 1 --n0 1 --n0x0 0 " + condition + " --s1 1 --n1 0"),
            static_cast<std::uint32_t>(seed));
        machine.step(sensors, 0.0);
        CHECK(machine.state() == 0);  // a state acts for a step before it is left
        machine.step(sensors, 0.1);
        left += machine.state() == 1 ? 1 : 0;
    }
    return static_cast<double>(left) / kRobots;
}

}  // namespace

TEST_CASE("a machine's text: states, parameters, and targets counted among the other states") {
    const auto states = parse_machine(
        "--nstates 3 --s0 0 --rwm0 50 --n0 2 --n0x0 0 --c0x0 0 --p0x0 0.5 --n0x1 1 --c0x1 3 --p0x1 4 --w0x1 "
        "7 "
        "--s1 4 --att1 3.5 --n1 2 --n1x0 0 --c1x0 5 --p1x0 0.01 --n1x1 1 --c1x1 2 --p1x1 1 --s2 1 --n2 0");
    REQUIRE(states.size() == 3);
    CHECK(states[0].kind == MachineState::Kind::Walk);
    CHECK(states[0].parameter == 50);
    CHECK(states[0].conditions[0].target == 1);
    CHECK(states[0].conditions[1].target == 2);
    CHECK(states[0].conditions[1].kind == MachineCondition::Kind::Neighbours);
    CHECK(states[0].conditions[1].w == 7);
    CHECK(states[1].parameter == 3.5);
    CHECK(states[1].conditions[0].target == 0);
    CHECK(states[1].conditions[1].target == 2);
    CHECK(states[2].conditions.empty());
}

TEST_CASE("a machine that is not one names the word") {
    const auto refused = [](const std::string& text) -> std::string {
        try {
            parse_machine(text);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "";
    };
    CHECK_THAT(refused(""), Contains("--nstates"));
    CHECK_THAT(refused("nstates 1"), Contains("nstates: expected an option"));
    CHECK_THAT(refused("--nstates"), Contains("a value behind it"));
    CHECK_THAT(refused("--nstates 0 --s0 1"), Contains("1 to 16, not 0"));
    CHECK_THAT(refused("--nstates 1 --s0 6"), Contains("--s0: expected a number, 0 to 5, not 6"));
    CHECK_THAT(refused("--nstates 1 --s0 0"), Contains("--rwm0"));
    CHECK_THAT(refused("--nstates 1 --s0 1 --s0 1"), Contains("--s0: expected it once"));
    CHECK_THAT(refused("--nstates 1 --s0 1 --rwm0 5"), Contains("--rwm0: expected no such option"));
    CHECK_THAT(refused("--nstates 2 --s0 1 --n0 1 --n0x0 1 --c0x0 5 --p0x0 1 --s1 1 --n1 0"),
               Contains("--n0x0: expected a number, 0 to 0, not 1"));
    CHECK_THAT(refused("--nstates 2 --s0 1 --n0 1 --n0x0 0 --c0x0 5 --p0x0 1.5 --s1 1 --n1 0"),
               Contains("--p0x0"));
    CHECK_THAT(refused("--nstates 2 --s0 1 --n0 1 --n0x0 0 --c0x0 3 --p0x0 4 --s1 1 --n1 0"),
               Contains("--w0x0"));
    CHECK_THAT(refused("--nstates 1 --s0 nan"), Contains("--s0"));
    CHECK_THAT(refused("--nstates 1.5 --s0 1"), Contains("--nstates: expected a whole number"));
}

TEST_CASE("any words are a machine or are refused") {
    const std::vector<std::string> words{
        "--nstates", "--s0", "--s1", "--n0", "--n0x0", "--c0x0", "--p0x0", "--w0x0", "--rwm0", "--att0",
        "0",         "1",    "2",    "5",    "-1",     "1e9",    "nan",    "x",      "--",     "0.5"};
    std::mt19937 random(Catch::rngSeed());
    int machines = 0;
    for (int round = 0; round < 20'000; ++round) {
        std::string text = random() % 2 == 0 ? "--nstates 1 --s0 " + std::to_string(random() % 3) : "";
        for (std::size_t i = random() % 12; i > 0; --i)
            text += " " + words[random() % words.size()];
        try {
            StateMachine machine(parse_machine(text), 1);
            machine.step({}, 0);
            ++machines;
        } catch (const std::runtime_error&) {
        }
    }
    CHECK(machines > 100);
}

TEST_CASE("modules of a machine drive where they say") {
    Sensors open;
    Sensors lamp = open;
    lamp.light[5] = 60;  // to the left
    Sensors wall = open;
    SECTION("to the light, and away from it") {
        const Actuators to = only("--s0 2").step(lamp, 0);
        CHECK(to.right_mm_s > to.left_mm_s + 50);
        const Actuators from = only("--s0 3").step(lamp, 0);
        CHECK(from.left_mm_s > from.right_mm_s + 50);
        const Actuators dark = only("--s0 2").step(open, 0);
        CHECK(dark.left_mm_s == dark.right_mm_s);
        CHECK(dark.left_mm_s > 100);
    }
    SECTION("to neighbours, and away from them, the nearer the more") {
        Sensors two = open;
        two.neighbours = {at(1.5, 10), at(-1.5, 60)};
        const Actuators to = only("--s0 4 --att0 5").step(two, 0);
        CHECK(to.right_mm_s > to.left_mm_s);
        const Actuators from = only("--s0 5 --rep0 5").step(two, 0);
        CHECK(from.left_mm_s > from.right_mm_s);
    }
    SECTION("obstacles are avoided by all but standing still") {
        StateMachine light = only("--s0 2"), still = only("--s0 1");
        light.step(lamp, 0);  // learns the offsets
        still.step(lamp, 0);
        wall = lamp;
        wall.proximity[5] = wall.proximity[6] = 2000;  // where the light is
        const Actuators away = light.step(wall, 0.1);
        CHECK(away.left_mm_s > away.right_mm_s);
        const Actuators stays = still.step(wall, 0.1);
        CHECK(stays.left_mm_s == 0);
        CHECK(stays.right_mm_s == 0);
    }
    SECTION("a walk turns away from a wall for a drawn time, and goes on") {
        int shortest = 1000, longest = 0;
        for (std::uint32_t seed = 1; seed <= 50; ++seed) {
            StateMachine walk = only("--s0 0 --rwm0 20", seed);
            walk.step(open, 0);
            wall = open;
            wall.proximity[0] = 3000;  // front right
            Actuators out = walk.step(wall, 0.1);
            int steps = 1;
            for (; out.left_mm_s < 0 && steps < 100; ++steps) {
                CHECK(out.right_mm_s > 0);
                out = walk.step(open, 0.1 * steps);
            }
            CHECK(out.left_mm_s > 100);
            shortest = std::min(shortest, steps);
            longest = std::max(longest, steps);
        }
        CHECK(shortest < 8);
        CHECK(longest > 15);
        CHECK(longest <= 21);
    }
}

TEST_CASE("conditions of a machine hold as often as they should") {
    Sensors grey;
    grey.ground = {640, 644, 638};
    Sensors black = grey, white = grey, edge = grey;
    black.ground = {327, 330, 325};
    white.ground = {953, 950, 930};
    edge.ground = {327, 640, 642};
    CHECK(share_left("--c0x0 0 --p0x0 1", black) == 1);
    CHECK(share_left("--c0x0 0 --p0x0 1", edge) == 0);
    CHECK(share_left("--c0x0 0 --p0x0 0.25", black) == Approx(0.25).margin(0.03));
    CHECK(share_left("--c0x0 1 --p0x0 1", grey) == 1);
    CHECK(share_left("--c0x0 2 --p0x0 1", white) == 1);
    CHECK(share_left("--c0x0 2 --p0x0 1", grey) == 0);
    CHECK(share_left("--c0x0 0 --p0x0 1", Sensors{}) == 0);  // without ground sensors
    CHECK(share_left("--c0x0 5 --p0x0 0.1", grey) == Approx(0.1).margin(0.02));
    Sensors four = grey;
    for (int i = 0; i < 4; ++i)
        four.neighbours.push_back(at(0.1 * i, 20));
    CHECK(share_left("--c0x0 3 --p0x0 4 --w0x0 3", four) == Approx(0.5).margin(0.03));
    CHECK(share_left("--c0x0 3 --p0x0 3 --w0x0 2", four) == Approx(1 / (1 + std::exp(-2.0))).margin(0.03));
    CHECK(share_left("--c0x0 4 --p0x0 3 --w0x0 2", four) == Approx(1 / (1 + std::exp(2.0))).margin(0.03));
    CHECK(share_left("--c0x0 3 --p0x0 4 --w0x0 20", grey) == 0);
}
