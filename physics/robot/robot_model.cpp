#include "physics/robot/robot_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {
constexpr double kGroundFullScale = 1023;
constexpr double kAccelerationWindow = 0.1;  // s: what a log at the control period calls acceleration
}  // namespace

template <std::size_t N>
void RobotModel::store(std::size_t channel, const std::array<double, N>& values) {
    std::copy(values.begin(), values.end(), channels_.begin() + static_cast<std::ptrdiff_t>(channel));
}

RobotModel::RobotModel(const World& world, const Robot& robot, const Parameters& parameters)
    : parameters_(parameters),
      ambient_light_(world.ambient_light),
      drives_{
          WheelDrive(parameters.robot, RandomStream(world.seed, "physics/" + robot.name + "/steps_left")),
          WheelDrive(parameters.robot, RandomStream(world.seed, "physics/" + robot.name + "/steps_right"))},
      floor_motion_(parameters, RandomStream(world.seed, "physics/" + robot.name + "/pushes")),
      proximity_(parameters.proximity),
      proximity_noise_(parameters.proximity, world.seed, robot.name),
      late_reflected_(parameters.proximity.age),
      light_(parameters.light, parameters.proximity, world.ambient_light, world.lamps),
      ground_(parameters.ground, world.arena.floor_grey, world.patches),
      late_greys_(parameters.ground.lag),
      late_speed_(kAccelerationWindow),
      ground_noise_(world.seed, "physics/" + robot.name + "/ground_noise"),
      accelerometer_(parameters.accelerometer, parameters.world, world.seed, robot.name),
      turns_(robot.ground_signals.contains(std::string(channel_name(kForceChannel)))),
      ears_(parameters.microphone, world.speakers),
      battery_(parameters.battery) {
    channels_[kMicrophoneLostChannel] = parameters.microphone.window_lost;
    light_the_floor();
}

void RobotModel::light_the_floor() {
    const double ambient = std::min(parameters_.ground.ambient * ambient_light_, kGroundFullScale);
    store(kGroundAmbientChannel, std::array<double, kGroundSensors>{ambient, ambient, ambient});
}

void RobotModel::scene_changed(const World& world) {
    ambient_light_ = world.ambient_light;
    light_.set_room(world.ambient_light, world.lamps);
    ground_.set_floor(world.arena.floor_grey, world.patches);
    ears_.set_speakers(world.speakers);
    looked_around_ = true;  // the room light is part of a reading
    if (!ears_.any()) store(kMicrophoneChannel, std::array<double, kMicrophones>{});
    light_the_floor();
}

double RobotModel::wheel_speed(Side side, double seconds, double wheel_angle) {
    const auto i = static_cast<std::size_t>(side);
    auto& drive = drives_[i];
    const double before = asked_angle_[i] - drive.pull_out(wheel_angle);
    asked_angle_[i] = drive.angle(seconds);
    return (asked_angle_[i] - before) / kStepSeconds +
           (before - wheel_angle) / parameters_.robot.drive_compliance;
}

FloorVelocity RobotModel::floor_velocity(const RobotState& state, double seconds) {
    const auto& body = parameters_.robot;
    const std::array<double, 2> rolls{(state.wheel[0] - rolled_[0]) / kStepSeconds * body.wheel_radius_left,
                                      (state.wheel[1] - rolled_[1]) / kStepSeconds * body.wheel_radius_right};
    rolled_ = state.wheel;
    const bool driven = drives_[0].driven(seconds) || drives_[1].driven(seconds);
    return floor_motion_.velocity({rolls, state.heading, driven, seconds}, kStepSeconds);
}

void RobotModel::look_around(const SensorView& view) {
    const auto now = proximity_.reflected(view);
    if (now == reflected_) return;
    reflected_ = now;
    looked_around_ = true;
}

void RobotModel::sense_light(const SensorView& view) {
    store(kAmbientChannel, light_.sense(view));
}

void RobotModel::look_down(const RobotState& state) {
    if (felt_ground_)
        greys_.fill(*felt_ground_);
    else
        greys_ = ground_.greys(state);
    over_ground_ = state;
}

int RobotModel::motors_running(double seconds) const {
    return (drives_[0].running(seconds) ? 1 : 0) + (drives_[1].running(seconds) ? 1 : 0);
}

Surroundings RobotModel::surroundings(double seconds) const {
    return {.seconds = seconds,
            .ambient = ambient_light_,
            .battery = battery_.voltage(),
            .motors = motors_running(seconds) / 2.0,
            .motor_speed = (drives_[0].speed(seconds) + drives_[1].speed(seconds)) / 2.0};
}

void RobotModel::sense_proximity(const Surroundings& now) {
    const bool same = !looked_around_ && !late_reflected_.delays() && !proximity_.varies_with_time() &&
                      !proximity_noise_.any();
    if (same) return;
    looked_around_ = false;
    auto counts = proximity_.answer(late_reflected_.next(reflected_), now);
    if (proximity_noise_.any()) proximity_noise_.add(counts, now);
    store(kProximityChannel, proximity_.readable(counts));
}

void RobotModel::sample_ground(double seconds) {
    auto counts = ground_.counts(greys_to_sample_, over_ground_, {seconds, acceleration_, lifted_});
    if (parameters_.ground.noise > 0.0)
        for (double& value : counts)
            value = std::clamp(value + parameters_.ground.noise * ground_noise_.normal(), 0.0,
                               parameters_.ground.saturation);
    store(kGroundChannel, counts);
}

/// What an LSM330 feels. Positive turns are counter-clockwise, seen from the axis's tip.
void RobotModel::sense_turning(const RobotState& state) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    store(kForceChannel, accelerometer_.in_g());
    const std::array<double, 3> angles{state.roll, state.pitch, state.heading};
    std::array<double, 3> rates{};
    for (std::size_t i = 0; i < angles.size(); ++i)
        rates[i] = std::remainder(angles[i] - last_angles_.value_or(angles)[i], 2 * std::numbers::pi) /
                   kStepSeconds * kDegrees;
    last_angles_ = angles;
    store(kTurnRateChannel, rates);
}

void RobotModel::sense_each_step(const RobotState& state, double seconds) {
    const Surroundings now = surroundings(seconds);
    sense_proximity(now);
    greys_to_sample_ = late_greys_.next(greys_);
    if (parameters_.ground.acceleration_tilt != 0.0) {
        const double speed =
            state.velocity[0] * std::cos(state.heading) + state.velocity[1] * std::sin(state.heading);
        acceleration_ = (speed - late_speed_.next({speed})[0]) / kAccelerationWindow;
    }
    const auto step = std::llround(seconds / kStepSeconds);
    if (step % std::max(1L, std::lround(parameters_.ground.period / kStepSeconds)) == 0)
        sample_ground(seconds);
    store(kAccelerationChannel, accelerometer_.sense(state, now));
    if (turns_) sense_turning(state);
    if (ears_.any()) store(kMicrophoneChannel, ears_.hear(state, seconds, now.motor_speed));
    channels_[kBatteryVoltageChannel] = battery_.draw(motors_running(seconds));
    channels_[kBatteryLowChannel] = battery_.low() ? 1.0 : 0.0;
}

}  // namespace puckloop::physics
