#pragma once
// Small worlds of range-and-bearing boards, and their links' signal ids.

#include "physics/ir/ir_medium.h"
#include "tests/physics/worlds.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics::test {

inline constexpr std::uint16_t kDemod = 0, kPeak = 12, kEmitter = 24, kCarrierId = 36, kPowerId = 37;
inline constexpr double kFirmwareCarrier = 482353;
inline constexpr std::uint16_t kAllEmitters = 0xFFF;
inline constexpr double kBodyRadius = 0.035;

inline Robot rab_robot(const std::string& name, double x, double y, double heading = 0.0) {
    Robot robot = robot_at(name, x, y, heading);
    robot.rab = true;
    for (std::uint16_t i = 0; i < kIrSensors; ++i) {
        const auto number = std::to_string(i + 1);
        robot.rab_signals["demod" + number] = static_cast<std::uint16_t>(kDemod + i);
        robot.rab_signals["peak" + number] = static_cast<std::uint16_t>(kPeak + i);
        robot.rab_signals["emitter" + number] = static_cast<std::uint16_t>(kEmitter + i);
    }
    robot.rab_signals["carrier"] = kCarrierId;
    robot.rab_signals["power"] = kPowerId;
    return robot;
}

/// "a" in the middle, "b" to its right, `surface` metres between the bodies.
inline World rab_pair(double surface, double heading_a = 0.0, double heading_b = 0.0) {
    World world;
    world.arena = rectangular_arena(4, 4);
    world.robots = {rab_robot("a", 0, 0, heading_a), rab_robot("b", 2 * kBodyRadius + surface, 0, heading_b)};
    return world;
}

/// No spread and no noise: every part is its type.
inline void make_ideal(World& world) {
    for (const char* name : {"ir.emitter_spread", "ir.receiver_spread", "ir.demodulator_spread",
                             "ir.frame_noise", "ir.receiver_noise", "ir.carrier_noise", "ir.near_noise"})
        world.parameters[name] = 0.0;
}

/// The pair of such boards; a looks at b.
inline World ideal_pair(double surface, double heading_b = 0.0) {
    World world = rab_pair(surface, 0.0, heading_b);
    make_ideal(world);
    return world;
}

/// Light of board 0 with `mask` on, at board 1.
inline const IrLight& shine(IrMedium& medium, std::uint16_t mask = kAllEmitters, double power = 115,
                            double carrier = kFirmwareCarrier) {
    medium.set_power(0, power);
    medium.set_carrier(0, carrier);
    medium.set_emitters(0, mask);
    medium.begin_burst(0, 0);
    return medium.from(0, 1);
}

inline std::size_t strongest(const IrArray<float>& values) {
    return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

inline double total(const IrArray<float>& values) {
    double sum = 0.0;
    for (const float value : values)
        sum += value;
    return sum;
}

}  // namespace puckloop::physics::test
