// Waves of sound through the world: delay, distance, several sources, and silence that costs nothing.

#include "physics/node/world_node.h"
#include "physics/sensors/sound_waves.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using cosim::Message;
using cosim::Signal;
using cosim::Time;

namespace {

constexpr std::uint16_t kSpeaker = 73, kSound = 74;
constexpr double kMicX[] = {.015, .015, -.03}, kMicY[] = {-.026, .026, 0}, kMicHeight = 0.03;
constexpr double kSpeakerHeight = 0.045;

World hearing_world(std::vector<Robot> robots) {
    World world;
    world.arena = rectangular_arena(4, 4);
    for (Robot& robot : robots) {
        robot.board_signals["speaker"] = kSpeaker;
        for (int i = 0; i < 3; ++i)
            robot.board_signals["sound" + std::to_string(i)] = static_cast<std::uint16_t>(kSound + i);
        world.robots.push_back(robot);
    }
    return world;
}

/// Everything that the world sends of sound, by port and signal, in `slice` grants.
using Heard = std::map<std::pair<int, int>, std::vector<std::pair<Time, double>>>;
Heard run(const World& world, std::vector<Message> inbox, Time duration, Time slice) {
    WorldNode node(world);
    Heard heard;
    std::size_t next = 0;
    for (Time until = slice; until <= duration; until += slice) {
        std::vector<Message> part, out;
        for (; next < inbox.size() && inbox[next].time < until; ++next)
            part.push_back(inbox[next]);
        const Time eot = node.earliest_output(0);
        node.advance(until, part, out);
        for (const Message& message : out) {
            const auto* signal = std::get_if<Signal>(&message.payload);
            REQUIRE(signal != nullptr);
            if (signal->id < kSound) continue;
            CHECK(message.time >= eot);
            CHECK(message.time > until - slice);
            auto& list = heard[{message.port, signal->id - kSound}];
            CHECK((list.empty() || list.back().first < message.time));
            list.emplace_back(message.time, signal->value);
        }
    }
    return heard;
}

double value_at(const std::vector<std::pair<Time, double>>& list, Time time) {
    double value = 0.0;
    for (const auto& [at, now] : list)
        if (at <= time) value = now;
    return value;
}

double distance(const Robot& ear, int mic, double x, double y, double height) {
    const double c = std::cos(ear.heading), s = std::sin(ear.heading);
    const double mx = ear.x + c * kMicX[mic] - s * kMicY[mic], my = ear.y + s * kMicX[mic] + c * kMicY[mic];
    return std::hypot(x - mx, y - my, height - kMicHeight);
}

/// A chirp at 7200 samples a second.
double chirp(double seconds) {
    return seconds < 0 || seconds > 0.05
               ? 0.0
               : 0.8 * std::sin(2 * 3.14159265358979 * (300 + 8000 * seconds) * seconds);
}
std::vector<Message> chirp_of(cosim::PortIndex port, double begin) {
    std::vector<Message> messages;
    constexpr double kRate = 7200;
    for (int i = 0; i <= 361; ++i) {
        const double at = begin + i / kRate;
        messages.push_back({cosim::from_seconds(at), port, Signal{kSpeaker, chirp(i / kRate)}});
    }
    return messages;
}

}  // namespace

TEST_CASE("what a speaker plays comes to each microphone later and weaker by its way", "[sound]") {
    std::mt19937 random(Catch::rngSeed());
    std::uniform_real_distribution<double> place(-1.2, 1.2), turn(-3, 3);
    const std::vector<Robot> robots{robot_at("a", place(random), 1.3 + 0.2 * place(random), turn(random)),
                                    robot_at("b", place(random), -1.3 + 0.2 * place(random), turn(random))};
    CAPTURE(robots[0].x, robots[0].y, robots[0].heading, robots[1].x, robots[1].y, robots[1].heading);
    const double begin = 0.01 + 0.001 * static_cast<double>(random() % 9);
    const auto heard =
        run(hearing_world(robots), chirp_of(0, begin), 120 * cosim::kMillisecond, cosim::kMillisecond);
    for (int robot = 0; robot < 2; ++robot)
        for (int mic = 0; mic < 3; ++mic) {
            const auto found = heard.find({2 * robot, mic});
            REQUIRE(found != heard.end());
            const Robot& ear = robots[static_cast<std::size_t>(robot)];
            const double way = distance(ear, mic, robots[0].x, robots[0].y, kSpeakerHeight);
            const double amplitude = 600 * 0.5 * 0.1 / way;
            double worst = 0.0;
            for (int i = 0; i < 1600; ++i) {
                const Time time = 5 * cosim::kMillisecond + i * kSoundPeriod;
                // Half a millisecond and more is what steps cost; a sample of the codec is a line late.
                const double made =
                    cosim::to_seconds(time) - kSoundLatency - way / kSpeedOfSound - begin - 1.0 / 7200;
                worst = std::max(worst, std::abs(value_at(found->second, time) - amplitude * chirp(made)));
            }
            // Straight lines between 7200 samples a second of up to 1.1 kHz.
            CHECK(worst < 0.13 * amplitude + 0.2);
            CHECK(found->second.back().second == 0.0);
        }
}

TEST_CASE("grants cut anyhow hear the same, and two speakers add", "[sound]") {
    const std::vector<Robot> robots{robot_at("a", 0, 0), robot_at("b", 0.4, 0), robot_at("c", 0.1, 0.5)};
    const World world = hearing_world(robots);
    const auto one = chirp_of(0, 0.01), two = chirp_of(2, 0.0173);
    std::vector<Message> both(one);
    both.insert(both.end(), two.begin(), two.end());
    std::stable_sort(both.begin(), both.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    constexpr Time kLong = 100 * cosim::kMillisecond;
    const auto whole = run(world, both, kLong, kLong);
    CHECK(whole == run(world, both, kLong, 500 * cosim::kMicrosecond));
    const auto first = run(world, one, kLong, kLong), second = run(world, two, kLong, kLong);
    for (const auto& [ear, list] : whole)
        for (Time time = 0; time < kLong; time += 7 * kSoundPeriod)
            CHECK(value_at(list, time) ==
                  Approx(value_at(first.at(ear), time) + value_at(second.at(ear), time)).margin(0.2));
}

TEST_CASE("nothing is published while nothing sounds", "[sound]") {
    World world = hearing_world({robot_at("a", 0, 0), robot_at("b", 0.4, 0)});
    world.speakers = {{.name = "noise", .x = 1.0, .level = 100}};
    CHECK(run(world, {}, 50 * cosim::kMillisecond, cosim::kMillisecond).empty());
    const auto heard = run(world, chirp_of(0, 0.001), 400 * cosim::kMillisecond, cosim::kMillisecond);
    for (const auto& [ear, list] : heard)
        CHECK(list.back().first < 60 * cosim::kMillisecond);
}
