#include "selftest/plain/plain_motion.h"

#include "physics/description/robot_constants.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kClockTick = 1e-3;  // s
constexpr double kSameTime = 1e-9;   // s
constexpr double kRadius = physics::kWheelRadius, kAxle = physics::kAxleLength;
using physics::kStepsPerTurn;
constexpr double kGravityOnFloor = 9.81;  // m/s2
constexpr double kSlipGroup = 4.0;        // steps: the coils' pattern repeats
constexpr double kPatchEdge = 0.15;       // m
constexpr double kFullSpeed = 1000;       // steps/s: the firmware's clamp

/// A command on its way to the motors.
struct Arrival {
    double at, left, right;
};

std::vector<Arrival> arrivals(const MotionKnobs& k, const MotionScript& script, RandomStream& chance) {
    std::vector<Arrival> list;
    for (const WheelCommand& c : script.commands) {
        const double jitter = k.latency_jitter * std::abs(chance.normal());
        const bool lost = chance.uniform() < k.drop && !list.empty();
        if (!lost) list.push_back({c.begin + k.latency + jitter, c.left, c.right});
    }
    return list;
}

/// One wheel from motor steps to ground speed.
struct Wheel {
    double motor = 0.0;    // m commanded to the gear
    double geared = 0.0;   // m behind the play
    double ground = 0.0;   // m/s over the floor
    double steps = 0.0;    // commanded so far
    double counted = 0.0;  // what the firmware counts

    /// By a tick, in the last `share_of_tick` of which the newest command is in force.
    double advance(const MotionKnobs& k, double radius, double steps_per_second, double share_of_tick,
                   RandomStream& chance) {
        const double wanted = steps_per_second * kClockTick;
        steps += wanted;
        // The rotor jumps to the next step as it is counted: counter and wheel part by half a step at most,
        // in either direction alike, so that the counter adds no play of its own.
        counted = std::round(steps);
        const double real = std::abs(steps_per_second) < k.deadband ? 0.0 : wanted;
        double skipped = 0.0;  // steps that the rotor slid back
        if (k.loss_speed > 0.0 && wanted != 0.0) {
            const double share =
                1.0 / (1.0 + std::exp((k.loss_speed - std::abs(steps_per_second)) / k.loss_width));
            if (chance.uniform() < share * std::abs(wanted) / kSlipGroup)
                skipped = std::copysign(kSlipGroup, wanted);
        }
        const double turned = motor / radius;
        motor +=
            real * 2 * std::numbers::pi * radius * (1.0 + k.eccentricity * std::sin(turned)) / kStepsPerTurn;
        const double before = geared;
        geared = std::clamp(geared, motor - k.backlash / 2, motor + k.backlash / 2);
        const double rim = (geared - before) / kClockTick;
        const double most = k.friction * kGravityOnFloor * kClockTick * share_of_tick;
        ground += std::clamp(rim - ground, -most, most);
        return ground - skipped * 2 * std::numbers::pi * radius / kStepsPerTurn / kClockTick;
    }
};

}  // namespace

double agenda_speed(double command) {
    const double speed = std::min(std::abs(command), kFullSpeed);
    if (speed < 1.0) return 0.0;
    return std::copysign(1e4 / std::floor(1e4 / speed), command);
}

std::vector<MotionRow> drive(const MotionKnobs& k, const MotionScript& script, double period,
                             RandomStream chance) {
    const auto list = arrivals(k, script, chance);
    const double radius_left = kRadius * k.radius_scale * (1.0 - k.mismatch);
    const double radius_right = kRadius * k.radius_scale * (1.0 + k.mismatch);
    const double axle = kAxle * k.axle_scale;
    const double kept = 1.0 - k.creep * script.load;
    Wheel left, right;
    double x = 0.0, y = 0.0, heading = script.heading, kick = 0.0;
    std::size_t next = 0;
    double speed_left = 0.0, speed_right = 0.0, old_left = 0.0, old_right = 0.0;
    struct Pose {
        double x, y, heading;
    };
    std::vector<Pose> past;
    std::vector<MotionRow> rows;
    const auto per_row = static_cast<long>(std::lround(period / kClockTick));
    const auto ticks = static_cast<long>(std::lround(script.seconds / kClockTick));
    const auto delay = static_cast<std::size_t>(std::lround(k.tracker_delay / kClockTick));
    for (long tick = 0; tick <= ticks; ++tick) {
        const double t = static_cast<double>(tick) * kClockTick;
        double mean_left = speed_left, mean_right = speed_right, share = 1.0;  // over this tick
        for (; next < list.size() && list[next].at < t + kClockTick - kSameTime; ++next) {
            const Arrival& command = list[next];
            const double left_now = agenda_speed(command.left), right_now = agenda_speed(command.right);
            if (left_now == speed_left && right_now == speed_right) continue;
            share = command.at < t + kSameTime ? 1.0 : 1.0 - (command.at - t) / kClockTick;
            mean_left += share * (left_now - speed_left);
            mean_right += share * (right_now - speed_right);
            speed_left = left_now;
            speed_right = right_now;
            if ((command.left + command.right) * (old_left + old_right) < 0.0) kick += k.thrust;
            if (command.left + command.right != 0.0) {
                old_left = command.left;
                old_right = command.right;
            }
        }
        past.push_back({x, y, heading + kick});
        if (tick % per_row == 0) {
            const Pose& p = past[past.size() - 1 - std::min(delay, past.size() - 1)];
            double cl = 0.0, cr = 0.0;
            for (const WheelCommand& c : script.commands)
                if (c.begin <= t + 1e-9) cl = c.left, cr = c.right;
            const double mx = p.x + std::cos(p.heading) * k.marker_x - std::sin(p.heading) * k.marker_y;
            const double my = p.y + std::sin(p.heading) * k.marker_x + std::cos(p.heading) * k.marker_y;
            const double stretch = 1.0 + k.lens * (mx * mx + my * my);
            rows.push_back({t, cl, cr, left.counted, right.counted, mx * stretch, my * stretch,
                            p.heading + k.heading_drift * t});
        }
        double vl = kept * left.advance(k, radius_left, mean_left, share, chance);
        double vr = kept * right.advance(k, radius_right, mean_right, share, chance);
        if (x > kPatchEdge) {
            vl *= 1.0 - k.patch;
            vr *= 1.0 - k.patch;
        }
        const double v = (vl + vr) / 2;
        const double difference = vr - vl;
        double base = axle;
        if (k.scrub != 0.0 && difference != 0.0) {
            const double w = std::abs(difference) / axle;
            base *= 1.0 + k.scrub * w / (std::abs(v) + w * axle / 2) * (axle / 2);
        }
        const double turn = difference / base * kClockTick;
        const bool moving = vl != 0.0 || vr != 0.0;
        x += v * kClockTick * std::cos(heading + kick + turn / 2) + (moving ? k.pull_x * kClockTick : 0.0);
        y += v * kClockTick * std::sin(heading + kick + turn / 2) + (moving ? k.pull_y * kClockTick : 0.0);
        heading += turn;
        if (k.push_rate > 0.0 && chance.uniform() < k.push_rate * kClockTick) {
            const double way = 2 * std::numbers::pi * chance.uniform();
            x += k.push_size * std::cos(way);
            y += k.push_size * std::sin(way);
        }
    }
    return rows;
}

}  // namespace puckloop::gap::selftest
