#include "selftest/emulate/plans.h"

#include "base/error.h"
#include "base/random.h"
#include "physics/description/parameters.h"
#include "selftest/benches/design_motion.h"
#include "selftest/emulate/plans_sensors.h"
#include "selftest/emulate/wave_floor.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::gap::emulate {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSend = 0.1;  // s
constexpr const char* kOpenFloor = "[arena]\nsize = [\"6 m\", \"6 m\"]\n";
constexpr double kStripe = 0.06;  // m
constexpr std::array<double, 6> kGreys{1.0, 0.0, 0.5, 1.0, 0.25, 0.75};
constexpr double kNearest = 0.041;  // m from the axle to the wall: nearer, a micrometre is a count
constexpr double kSettled = 0.5;    // s at each stop of an approach
constexpr double kSlow = 80;        // steps/s: a sensor's schedule of 13 ms is then 0.13 mm
constexpr double kAside = 0.013;    // m from a side sensor to the wall that the robot drives along
constexpr double kBegin = 0.085, kEnd = 0.052;  // m from the axle to the wall, of a slow drive to and fro
constexpr double kTilt = 0.1;                   // rad of the table in some drives

Act drive_of(const selftest::PlannedDrive& plan) {
    Act act;
    act.conditions = {{"path", plan.path}, {"sense", plan.sense}};
    act.arena = kOpenFloor;
    act.heading = plan.script.heading;
    act.load = plan.script.load;
    for (const auto& c : plan.script.commands)
        act.commands.push_back({c.begin, c.left, c.right});
    act.commands.push_back({plan.script.seconds, 0, 0});
    return act;
}

std::vector<Act> motion_acts(std::uint64_t seed, bool brief) {
    RandomStream random(seed, "drives on the emulator");
    std::vector<Act> acts, loaded;
    for (const auto& plan : selftest::planned_drives(random, false)) {
        if (brief && acts.size() >= 4) break;
        (plan.script.load > 0.0 ? loaded : acts).push_back(drive_of(plan));
    }
    if (brief) return acts;
    // With a load on the back, and the same line up, down and along a tilted table without it.
    acts.insert(acts.end(), loaded.begin(), loaded.end());
    for (const double uphill : {0.0, std::numbers::pi, 0.5 * std::numbers::pi, 0.1}) {
        Act act = loaded.front();
        act.load = 0.0;
        act.slope_x = kTilt;
        act.heading = uphill + 0.1 * (random.uniform() - 0.5);
        acts.push_back(std::move(act));
    }
    return acts;
}

std::string wall(bool lamp) {
    return fmt::format(
        "[arena]\nsize = [\"4 m\", \"4 m\"]\n[light]\nambient = {}\n[[box]]\ncentre = [\"{} m\", \"0 m\"]\n"
        "size = [\"10 cm\", \"120 cm\", \"12 cm\"]\n",
        lamp ? 1 : 0, kWallFace + 0.05);
}

/// The robot drives along the wall, which stays as far from the sensor: motors on and off at one distance.
Act along_wall(double facing) {
    Act act;
    act.conditions = {{"light", "dark"}, {"drive", "along"}};
    act.arena = wall(false);
    act.heading = -facing;
    act.x = kWallFace - physics::Parameters().proximity.y[5] - kAside;
    act.y = std::copysign(0.3, facing);
    act.commands = {{0, 0, 0}, {2, 150, 150}, {8, 0, 0}, {10, 500, 500}, {16, 0, 0}, {18, 0, 0}};
    return act;
}

/// Slowly towards the wall and back, twice, with a sensor facing it.
Act to_and_fro(double facing) {
    Act act;
    act.conditions = {{"light", "dark"}, {"drive", "to and fro"}};
    act.arena = wall(false);
    act.heading = -facing;
    act.x = kWallFace - kBegin;
    const double steps = std::copysign(kSlow, std::cos(facing));
    const double seconds = std::round((kBegin - kEnd) / (kSlow * kMetresPerStep) / kSend) * kSend;
    double t = 1.0;
    act.commands.push_back({0, 0, 0});
    for (int k = 0; k < 4; ++k) {
        const double now = k % 2 == 0 ? steps : -steps;
        act.commands.push_back({t, now, now});
        t += seconds;
    }
    act.commands.push_back({t, 0, 0});
    act.commands.push_back({t + kSettled, 0, 0});
    return act;
}

/// The robot goes towards the wall (or backs up to it) with one sensor facing it, and stops to look.
Act approach(double facing, double start, bool lamp, bool brief) {
    Act act;
    const bool backing = std::abs(facing) > 90 * kDegree;
    act.conditions = {{"light", lamp ? "lamp" : "dark"}};
    act.arena = wall(lamp);
    // The sides look along the axle: the robot comes up slantwise.
    const double turned =
        std::abs(std::abs(facing) - 90 * kDegree) < 1 * kDegree ? std::copysign(35 * kDegree, facing) : 0.0;
    act.heading = -facing + turned;
    act.x = kWallFace - start;
    const double closing = std::abs(std::cos(act.heading));
    double t = 1.0;
    act.commands.push_back({0, 0, 0});
    const int stops = brief ? 4 : 12;
    const double way = (start - kNearest) / closing;
    for (int k = 0; k < stops; ++k) {
        // Short hops near the wall, where the answer is steep.
        const double hop = way * (stops - k) * 2 / (static_cast<double>(stops) * (stops + 1));
        const double speed = backing ? -300 : 300;
        const double seconds = std::max(1.0, std::round(hop / (300 * kMetresPerStep) / kSend)) * kSend;
        const double steps = std::round(hop / kMetresPerStep / seconds);
        act.commands.push_back({t, std::copysign(steps, speed), std::copysign(steps, speed)});
        t += seconds;
        act.commands.push_back({t, 0, 0});
        t += kSettled;
    }
    act.commands.push_back({t, 0, 0});
    return act;
}

std::vector<Act> proximity_acts(std::uint64_t seed, bool brief) {
    constexpr std::array<double, 8> facing{-17.2, -45.9, -90.0, -151.5, 151.2, 90.0, 45.8, 17.1};
    RandomStream random(seed, "approaches on the emulator");
    std::vector<Act> acts;
    for (int repeat = 0; repeat < (brief ? 1 : 2); ++repeat)
        for (std::size_t k = 0; k < facing.size(); k += brief ? 3 : 1)
            for (const bool lamp : {false, true}) {
                if (lamp && (brief || k % 4 != 0)) continue;
                acts.push_back(approach(facing[k] * kDegree, 0.12 + 0.01 * random.uniform(), lamp, brief));
            }
    if (!brief)
        for (const double side : {facing[2], facing[5]})
            acts.push_back(along_wall(side * kDegree));
    if (!brief)
        for (const double one : {facing[0], facing[7], facing[3], facing[4]})
            acts.push_back(to_and_fro(one * kDegree));
    // In random order, so that what changes with time is not what changes with the sensor.
    for (std::size_t k = acts.size(); k > 1; --k)
        std::swap(acts[k - 1], acts[random.below(k)]);
    return acts;
}

/// Over the wave floor at two speeds, with starts and stops between.
Act over_waves(bool back) {
    Act act;
    act.ground = true;
    act.arena = wave_floor();
    act.conditions = {{"drive", back ? "waves fro" : "waves to"}};
    act.heading = back ? std::numbers::pi : 0.0;
    act.x = back ? 0.1502 : -0.1502;  // no sensor stands on the seam between two stripes
    double t = 0.5;
    act.commands.push_back({0, 0, 0});
    for (const double speed : {150, 300, 150, 300}) {
        act.commands.push_back({t, speed, speed});
        t += speed > 200 ? 1.5 : 2.5;
        act.commands.push_back({t, 0, 0});
        t += 0.6;
    }
    act.commands.push_back({t, 0, 0});
    return act;
}

std::vector<Act> ground_acts(std::uint64_t seed, bool brief) {
    RandomStream random(seed, "crossings on the emulator");
    std::string floor = "[arena]\nsize = [\"3 m\", \"2 m\"]\n";
    for (int k = -10; k < 10; ++k)
        floor += fmt::format(
            "[[floor_patch]]\ncentre = [\"{} m\", \"0 m\"]\nsize = [\"{} m\", \"1.8 m\"]\ngrey = {}\n",
            (k + 0.5) * kStripe, kStripe, stripe_grey((k + 0.5) * kStripe));
    std::vector<Act> acts;
    for (int k = 0; k < (brief ? 2 : 6); ++k) {
        Act act;
        act.ground = true;
        act.arena = floor;
        act.conditions = {{"drive", k % 2 == 0 ? "to" : "fro"}};
        act.heading = (k % 2 == 0 ? 0.0 : std::numbers::pi) + 0.3 * (random.uniform() - 0.5);
        act.x = k % 2 == 0 ? -0.4 : 0.4;
        const double speed = 250 + 100 * std::floor(3 * random.uniform());
        act.commands = {{0, 0, 0}, {1, speed, speed}, {brief ? 6.0 : 13.0, 0, 0}, {brief ? 6.5 : 13.5, 0, 0}};
        acts.push_back(std::move(act));
    }
    for (int k = 0; k < (brief ? 0 : 4); ++k)
        acts.push_back(over_waves(k % 2 == 1));
    return acts;
}

std::vector<Act> timing_acts(std::uint64_t, bool brief) {
    std::vector<Act> acts;
    for (int k = 0; k < (brief ? 2 : 6); ++k) {
        Act act;
        act.arena = kOpenFloor;
        act.commands = {{0, 0, 0}, {1, 100.0 + 50 * k, 100}, {brief ? 6.0 : 20.0, 0, 0}};
        act.ground = true;
        act.ground_every = 3;
        act.relative = true;
        acts.push_back(std::move(act));
    }
    return acts;
}

}  // namespace

const std::vector<std::string>& recordable_kinds() {
    static const std::vector<std::string> kinds{"motion",     "proximity",     "ground", "timing",
                                                "microphone", "accelerometer", "serial", "rab"};
    return kinds;
}

std::vector<Act> acts_of(std::string_view kind, std::uint64_t seed, bool brief) {
    if (kind == "motion") return motion_acts(seed, brief);
    if (kind == "proximity") return proximity_acts(seed, brief);
    if (kind == "ground") return ground_acts(seed, brief);
    if (kind == "timing") return timing_acts(seed, brief);
    if (kind == "microphone") return microphone_acts(seed, brief);
    if (kind == "accelerometer") return accelerometer_acts(seed, brief);
    if (kind == "rab" || kind == "serial") return {};  // record_rab.h, record_serial.h
    throw InputError("", "gap record", fmt::format("'{}' cannot be recorded on the emulator", kind),
                     "motion, proximity, ground, timing, microphone, accelerometer, serial, rab or all");
}

double stripe_grey(double x) {
    const auto index = static_cast<long>(std::floor(x / kStripe));
    return kGreys[static_cast<std::size_t>(((index % 6) + 6) % 6)];
}

bool near_edge(double x, double reach) {
    const double place = x / kStripe - std::round(x / kStripe);
    return std::abs(place) * kStripe < reach;
}

}  // namespace puckloop::gap::emulate
