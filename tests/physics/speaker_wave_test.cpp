// Loudspeakers of a scenario that play waves: tones, sweeps and noise with their delays at the microphones,
// once or again and again, and nothing while they are silent.

#include "physics/node/world_node.h"
#include "physics/sensors/sound_waves.h"
#include "physics/sensors/speaker_wave.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <vector>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using cosim::Signal;
using cosim::Time;

namespace {

constexpr std::uint16_t kSound = 74;
constexpr double kMicX[] = {.015, .015, -.03}, kMicY[] = {-.026, .026, 0}, kMicHeight = 0.03;

/// By microphone: what is published of the wave at a robot in the middle, looking along x.
std::array<std::map<Time, double>, 3> heard(const World& world, Time duration) {
    WorldNode node(world);
    std::vector<cosim::Message> out;
    node.advance(duration, {}, out);
    std::array<std::map<Time, double>, 3> waves;
    for (const cosim::Message& message : out) {
        const auto* signal = std::get_if<Signal>(&message.payload);
        if (signal != nullptr && message.port == 0 && signal->id >= kSound)
            waves[signal->id - kSound][message.time] = signal->value;
    }
    return waves;
}

double value_at(const std::map<Time, double>& wave, Time time) {
    const auto after = wave.upper_bound(time);
    return after == wave.begin() ? 0.0 : std::prev(after)->second;
}

World world_with(std::vector<Speaker> speakers) {
    World world;
    world.arena = rectangular_arena(4, 4);
    Robot robot = robot_at("ear", 0, 0);
    for (int i = 0; i < 3; ++i)
        robot.board_signals["sound" + std::to_string(i)] = static_cast<std::uint16_t>(kSound + i);
    world.robots.push_back(robot);
    world.speakers = std::move(speakers);
    return world;
}

}  // namespace

TEST_CASE("a loudspeaker sounds when its keys ask for it, once or again", "[sound]") {
    const Speaker once{.name = "horn", .on = 1.0, .off = 1.5};
    CHECK_FALSE(into_sound(once, 0.999));
    CHECK(into_sound(once, 1.25) == 0.25);
    CHECK_FALSE(into_sound(once, 1.5));
    const Speaker claps{.name = "horn", .on = 1.0, .off = 1.03, .every = 0.5, .times = 3};
    std::mt19937 random(7);
    for (int i = 0; i < 1000; ++i) {
        const double at = static_cast<double>(random() % 4000) / 1000 + 0.0003;
        const bool sounds = (at >= 1 && at < 1.03) || (at >= 1.5 && at < 1.53) || (at >= 2 && at < 2.03);
        CAPTURE(at);
        CHECK(into_sound(claps, at).has_value() == sounds);
        const bool near = (at >= 0.9 && at < 1.03) || (at >= 1.4 && at < 1.53) || (at >= 1.9 && at < 2.03);
        CHECK(plays_within(claps, at, at + 0.1) == near);
    }
    const Speaker endless{.name = "horn", .on = 0.0, .off = 0.1, .every = 0.2};
    CHECK(into_sound(endless, 1000.05).has_value());
    CHECK_FALSE(into_sound(endless, 1000.15));
}

TEST_CASE("a tone has its frequency, a sweep goes from one to the other, noise is noise", "[sound]") {
    // Zero crossings upwards in a span.
    const auto crossings = [](const Speaker& speaker, double from, double until) {
        int count = 0;
        double before = wave_of(speaker, 1, from);
        for (double at = from; at < until; at += 1e-5) {
            const double value = wave_of(speaker, 1, at);
            count += before < 0 && value >= 0 ? 1 : 0;
            before = value;
        }
        return count;
    };
    CHECK(std::abs(crossings({.name = "horn", .on = 0.1, .off = 1.1, .tone = 440}, 0.1, 1.1) - 440) <= 1);
    const Speaker sweep{.name = "horn", .on = 0.1, .off = 1.1, .tone = 500, .sweep_to = 1500};
    CHECK(std::abs(crossings(sweep, 0.1, 0.2) - 55) <= 1);
    CHECK(std::abs(crossings(sweep, 1.0, 1.1) - 145) <= 1);
    CHECK(wave_of(sweep, 1, 0.05) == 0.0);

    const Speaker horn{.name = "horn", .wave = true}, other{.name = "other", .wave = true};
    double power = 0, same = 0, next = 0, most = 0;
    constexpr int kSamples = 16000;
    for (int i = 0; i < kSamples; ++i) {
        const double at = i / 16000.0, value = wave_of(horn, 1, at);
        power += value * value;
        same += value * wave_of(other, 1, at);
        next += value * wave_of(horn, 1, at + 1 / 16000.0);
        most = std::max(most, std::abs(value));
        CHECK(value != wave_of(horn, 2, at));
    }
    CHECK(power / kSamples == Approx(1.0 / 3).epsilon(0.05));  // evenly from -1 to 1
    CHECK(std::abs(same) < 0.03 * power);
    CHECK(std::abs(next) < 0.03 * power);
    CHECK((most > 0.99 && most <= 1.0));
}

TEST_CASE("a wave reaches each microphone by its distance, and there is nothing in between", "[sound]") {
    std::mt19937 random(Catch::rngSeed());
    std::uniform_real_distribution<double> place(0.2, 1.2);
    for (const bool tone : {true, false}) {
        Speaker speaker{.name = "horn", .x = -place(random), .y = place(random), .height = 0.03};
        speaker.level = 2000;
        speaker.on = 0.01;
        speaker.off = 0.04;
        speaker.every = 0.3;
        speaker.times = 2;
        (tone ? speaker.tone : speaker.level) = tone ? 700 : 2000;
        speaker.wave = !tone;
        CAPTURE(speaker.x, speaker.y, tone);
        const World world = world_with({speaker});
        const auto waves = heard(world, 500 * cosim::kMillisecond);
        for (std::size_t mic = 0; mic < 3; ++mic) {
            const double way =
                std::hypot(speaker.x - kMicX[mic], speaker.y - kMicY[mic], speaker.height - kMicHeight);
            const double amplitude = speaker.level / 2 * 0.1 / way;
            for (int i = 0; i < 8000; ++i) {
                const Time time = i * kSoundPeriod;
                const double made = cosim::to_seconds(time) - kSoundLatency - way / kSpeedOfSound;
                const double expected = amplitude * wave_of(speaker, world.seed, made);
                if (std::abs(value_at(waves[mic], time) - expected) > 0.1)
                    FAIL_CHECK(mic << " at " << i << ": " << value_at(waves[mic], time) << ", not "
                                   << expected);
            }
            // Between the two and behind them silence costs no message.
            for (const auto& [time, value] : waves[mic]) {
                const double at = cosim::to_seconds(time);
                CHECK(((at < 0.06) || (at > 0.3 && at < 0.36)));
            }
        }
    }
    Speaker steady{.name = "fan", .x = 0.5, .level = 500};
    CHECK(heard(world_with({steady}), 50 * cosim::kMillisecond)[0].empty());
}
