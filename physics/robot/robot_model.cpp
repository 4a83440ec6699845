#include "physics/robot/robot_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {
constexpr double kGroundFullScale = 1023;
constexpr double kAccelerationWindow = 0.1;  // s: what a log at the control period calls acceleration
constexpr double kConverter = 4095;          // counts, of the main board

double forward_speed(const RobotState& state) {
    return state.velocity[0] * std::cos(state.heading) + state.velocity[1] * std::sin(state.heading);
}
}  // namespace

template <std::size_t N>
void RobotModel::store(std::size_t channel, const std::array<double, N>& values) {
    std::copy(values.begin(), values.end(), channels_.begin() + static_cast<std::ptrdiff_t>(channel));
}

RobotModel::RobotModel(const World& world, const Robot& robot, const Parameters& parameters)
    : name_(robot.name),
      parameters_(parameters),
      ambient_light_(world.ambient_light),
      lamps_(lamps_sensed_by(world, robot.name)),
      drives_{
          WheelDrive(parameters.robot, RandomStream(world.seed, "physics/" + robot.name + "/steps_left")),
          WheelDrive(parameters.robot, RandomStream(world.seed, "physics/" + robot.name + "/steps_right"))},
      floor_motion_(parameters, RandomStream(world.seed, "physics/" + robot.name + "/pushes")),
      extension_(world.extension, world.seed, robot.name),
      late_rolled_(kSpeedWindow),
      proximity_(parameters.proximity),
      proximity_noise_(parameters.proximity, world.seed, robot.name),
      late_reflected_(parameters.proximity.age),
      light_(parameters.light, parameters.proximity, world.ambient_light, lamps_),
      ground_(parameters.ground, world.arena.floor_grey, world.patches),
      late_greys_(parameters.ground.lag),
      late_speed_(kAccelerationWindow),
      ground_noise_(world.seed, "physics/" + robot.name + "/ground_noise"),
      accelerometer_(parameters.accelerometer, parameters.world, world.seed, robot.name),
      turns_(robot.ground_signals.contains(std::string(channel_name(kForceChannel)))),
      ears_(parameters.microphone, world.speakers),
      battery_(parameters.battery) {
    faced_.fill({parameters.proximity.reach, 0.0});
    channels_[kMicrophoneLostChannel] = parameters.microphone.window_lost;
    light_the_floor();
}

void RobotModel::light_the_floor() {
    const double ambient = std::min(parameters_.ground.ambient * ambient_light_, kGroundFullScale);
    store(kGroundAmbientChannel, std::array<double, kGroundSensors>{ambient, ambient, ambient});
}

void RobotModel::scene_changed(const World& world) {
    ambient_light_ = world.ambient_light;
    lamps_ = lamps_sensed_by(world, name_);
    light_.set_room(world.ambient_light, lamps_);
    ground_.set_floor(world.arena.floor_grey, world.patches);
    ears_.set_speakers(world.speakers);
    looked_around_ = true;  // the room light is part of a reading
    if (!ears_.any()) store(kMicrophoneChannel, std::array<double, kMicrophones>{});
    light_the_floor();
}

void RobotModel::tune(std::string_view name, double value, const World& world) {
    parameters_.set(name, value);
    // What goes by parameters alone is made again; what remembers keeps what it does.
    proximity_ = ProximityRing(parameters_.proximity);
    light_ = LightRing(parameters_.light, parameters_.proximity, ambient_light_, lamps_);
    ground_ = GroundRow(parameters_.ground, world.arena.floor_grey, world.patches);
    proximity_noise_.set_parameters(parameters_.proximity);
    accelerometer_.set_parameters(parameters_.accelerometer);
    battery_.set_parameters(parameters_.battery);
    floor_motion_.set_parameters(parameters_);
    for (WheelDrive& drive : drives_)
        drive.set_parameters(parameters_.robot);
    looked_around_ = true;
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
    FloorVelocity floor = floor_motion_.velocity({rolls, state.heading, driven, seconds}, kStepSeconds);
    if (extension_.moves()) add_motion(floor, state, seconds, driven);
    return floor;
}

void RobotModel::add_motion(FloorVelocity& floor, const RobotState& state, double seconds, bool driven) {
    const auto& body = parameters_.robot;
    const std::array<double, 2> way{state.wheel[0] * body.wheel_radius_left,
                                    state.wheel[1] * body.wheel_radius_right};
    const auto before = late_rolled_.next(way);
    const double left = (way[0] - before[0]) / kSpeedWindow, right = (way[1] - before[1]) / kSpeedWindow;
    const double speed = (left + right) / 2;
    travelled_ += std::abs(speed) * kStepSeconds;
    if (!driven) return;
    Moment now{};
    known(now, Known::Speed) = speed;
    known(now, Known::TurnRate) = (right - left) / body.axle_length;
    known(now, Known::Heading) = std::remainder(state.heading, 2 * std::numbers::pi);
    known(now, Known::Time) = seconds;
    known(now, Known::Travelled) = travelled_;
    known(now, Known::Battery) = battery_.voltage();
    const double ahead = extension_.of(Extended::Forward, 0, now),
                 aside = extension_.of(Extended::Left, 0, now);
    const double cosine = std::cos(state.heading), sine = std::sin(state.heading);
    floor.x += cosine * ahead - sine * aside;
    floor.y += sine * ahead + cosine * aside;
    floor.turn += extension_.of(Extended::Turn, 0, now);
}

template <std::size_t N, class Each>
void RobotModel::add_counts(Extended quantity, std::array<double, N>& counts, double most,
                            const Surroundings& now, const Each& each) const {
    if (!extension_.adds_to(quantity)) return;
    Moment moment{};
    known(moment, Known::Time) = now.seconds;
    known(moment, Known::Battery) = now.battery;
    known(moment, Known::Ambient) = now.ambient;
    known(moment, Known::MotorSpeed) = now.motor_speed;
    for (std::size_t i = 0; i < N; ++i) {
        known(moment, Known::Level) = counts[i];
        each(i, moment);
        counts[i] = std::clamp(counts[i] + extension_.of(quantity, static_cast<int>(i), moment), 0.0, most);
    }
}

void RobotModel::add_force(std::array<double, 3>& counts, const RobotState& state,
                           const Surroundings& now) const {
    constexpr std::array<Extended, 3> kAxes{Extended::AccelerationX, Extended::AccelerationY,
                                            Extended::AccelerationZ};
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
        std::array<double, 1> one{counts[axis]};
        add_counts(kAxes[axis], one, kConverter, now, [&](std::size_t, Moment& moment) {
            known(moment, Known::Pitch) = -state.pitch;
            known(moment, Known::Roll) = state.roll;
            known(moment, Known::Speed) = forward_speed(state);
        });
        counts[axis] = one[0];
    }
}

void RobotModel::look_around(const SensorView& view) {
    if (extension_.asks(Extended::Proximity, Known::Distance) ||
        extension_.asks(Extended::Proximity, Known::Angle)) {
        faced_ = proximity_.faced(view);
        looked_around_ = true;
    }
    const auto now = proximity_.reflected(view);
    if (now == reflected_) return;
    reflected_ = now;
    looked_around_ = true;
}

void RobotModel::sense_light(const SensorView& view) {
    store(kAmbientChannel, light_.sense(view));
}

void RobotModel::look_down(const RobotState& state, std::span<const PheromoneField> trails) {
    if (felt_ground_)
        greys_.fill(*felt_ground_);
    else
        greys_ = ground_.greys(state, trails);
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
                      !proximity_noise_.any() && !extension_.adds_to(Extended::Proximity);
    if (same) return;
    looked_around_ = false;
    auto counts = proximity_.answer(late_reflected_.next(reflected_), now);
    add_counts(Extended::Proximity, counts, kConverter, now, [&](std::size_t i, Moment& moment) {
        known(moment, Known::Distance) = faced_[i].distance;
        known(moment, Known::Angle) = faced_[i].angle;
    });
    if (proximity_noise_.any()) proximity_noise_.add(counts, now);
    store(kProximityChannel, proximity_.readable(counts));
}

void RobotModel::sample_ground(const Surroundings& now) {
    auto counts = ground_.counts(greys_to_sample_, over_ground_, {now.seconds, acceleration_, lifted_});
    add_counts(Extended::Ground, counts, parameters_.ground.saturation, now,
               [&](std::size_t i, Moment& moment) {
                   known(moment, Known::Grey) = greys_to_sample_[i];
                   known(moment, Known::Speed) = forward_speed(over_ground_);
                   known(moment, Known::Acceleration) = acceleration_;
                   known(moment, Known::Pitch) = -over_ground_.pitch;
               });
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
    if (parameters_.ground.acceleration_tilt != 0.0 ||
        extension_.asks(Extended::Ground, Known::Acceleration)) {
        const double speed = forward_speed(state);
        acceleration_ = (speed - late_speed_.next({speed})[0]) / kAccelerationWindow;
    }
    const auto step = std::llround(seconds / kStepSeconds);
    if (step % std::max(1L, std::lround(parameters_.ground.period / kStepSeconds)) == 0) sample_ground(now);
    auto force = accelerometer_.sense(state, now);
    add_force(force, state, now);
    store(kAccelerationChannel, force);
    if (turns_) sense_turning(state);
    if (ears_.any()) {
        auto levels = ears_.hear(state, seconds, now.motor_speed);
        add_counts(Extended::Microphone, levels, kConverter, now, [](std::size_t, Moment&) {});
        store(kMicrophoneChannel, levels);
    }
    channels_[kBatteryVoltageChannel] = battery_.draw(motors_running(seconds));
    channels_[kBatteryLowChannel] = battery_.low() ? 1.0 : 0.0;
}

}  // namespace puckloop::physics
