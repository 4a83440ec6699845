#pragma once
// One e-puck in the world: its drives, its sensors, its battery, and what they last said.

#include "physics/description/channels.h"
#include "physics/dynamics/floor_motion.h"
#include "physics/robot/battery.h"
#include "physics/robot/delay_line.h"
#include "physics/robot/extension.h"
#include "physics/robot/wheel_drive.h"
#include "physics/sensors/accelerometer.h"
#include "physics/sensors/ground.h"
#include "physics/sensors/light.h"
#include "physics/sensors/proximity.h"
#include "physics/sensors/proximity_noise.h"
#include "physics/sensors/sound.h"

#include <array>
#include <optional>
#include <string_view>

namespace puckloop::physics {

enum class Side : std::uint8_t { Left, Right };

class RobotModel {
  public:
    /// `world` must outlive the model; `parameters` are the world's with the robot's own over them.
    RobotModel(const World& world, const Robot& robot, const Parameters& parameters);

    WheelDrive& drive(Side side) { return drives_[static_cast<std::size_t>(side)]; }
    const WheelDrive& drive(Side side) const { return drives_[static_cast<std::size_t>(side)]; }

    /// Wheel speed (rad/s) to ask for in the step that ends at `seconds`, from where the wheel is now.
    double wheel_speed(Side side, double seconds, double wheel_angle);

    const FloorMotion& floor_motion() const { return floor_motion_; }
    /// The floor under it does not move, whatever it does.
    bool floor_is_still() const { return floor_motion_.still() && !extension_.moves(); }
    /// How the floor moves under the robot in the step that ends at `seconds`; not asked for where it is
    /// still.
    FloorVelocity floor_velocity(const RobotState& state, double seconds);

    /// These three when something moved: what the sensors look at is another.
    void look_around(const SensorView& view);
    void sense_light(const SensorView& view);
    void look_down(const RobotState& state, std::span<const PheromoneField> trails = {});
    /// What the sensors say of it, and what changes by itself; once a step, after the others.
    void sense_each_step(const RobotState& state, double seconds);

    /// The world's lamps, floor, loudspeakers or room light changed.
    void scene_changed(const World& world);
    /// Held in the air: nothing is under it or around it.
    void set_lifted(bool lifted) { lifted_ = lifted; }
    bool lifted() const { return lifted_; }
    /// A grey that its ground sensors see in place of the floor; none: the floor. From the next look_down()
    /// on.
    void set_felt_ground(std::optional<double> grey) { felt_ground_ = grey; }
    const std::optional<double>& felt_ground() const { return felt_ground_; }
    void set_charge(double charge) { battery_.set_charge(charge); }
    /// Another value of a parameter for which problem_of_tuning() is empty; `world` as at the beginning, with
    /// what changed since.
    void tune(std::string_view name, double value, const World& world);

    const ProximityRing& proximity() const { return proximity_; }
    const LightRing& light() const { return light_; }
    double sensor_height() const { return parameters_.proximity.height; }
    const BodyParameters& body() const { return parameters_.robot; }
    const Channels& channels() const { return channels_; }
    /// What the readings are made of: own light that comes back, grey under the ground sensors.
    const std::array<double, kProximitySensors>& reflected() const { return reflected_; }
    const std::array<double, kGroundSensors>& greys() const { return greys_; }

  private:
    int motors_running(double seconds) const;
    Surroundings surroundings(double seconds) const;
    void sense_proximity(const Surroundings& now);
    void light_the_floor();
    void sample_ground(const Surroundings& now);
    void sense_turning(const RobotState& state);
    /// What the terms without a mechanism add to how it goes over the floor; once a step.
    void add_motion(FloorVelocity& floor, const RobotState& state, double seconds, bool driven);
    /// What they add to readings of so many sensors; `each` fills in what a sensor knows besides.
    template <std::size_t N, class Each>
    void add_counts(Extended quantity, std::array<double, N>& counts, double most, const Surroundings& now,
                    const Each& each) const;
    void add_force(std::array<double, 3>& counts, const RobotState& state, const Surroundings& now) const;
    template <std::size_t N>
    void store(std::size_t channel, const std::array<double, N>& values);

    std::string name_;
    Parameters parameters_;
    double ambient_light_;
    std::vector<Lamp> lamps_;  // those that it senses
    std::array<WheelDrive, 2> drives_;
    std::array<double, 2> asked_angle_{};
    FloorMotion floor_motion_;
    std::array<double, 2> rolled_{};  // rad, when the floor's motion was last asked for
    Extension extension_;
    DelayLine<2> late_rolled_;  // rad, of both wheels
    double speed_ = 0.0, turn_rate_ = 0.0,
           travelled_ = 0.0;  // m/s, rad/s, m: by the wheels; kept where asked for
    std::array<FacedSurface, kProximitySensors> faced_{};  // likewise
    ProximityRing proximity_;
    ProximityNoise proximity_noise_;
    std::array<double, kProximitySensors> reflected_{};
    DelayLine<kProximitySensors> late_reflected_;
    bool looked_around_ = true;  // what is seen, or the room light, is another since the last reading
    bool lifted_ = false;
    LightRing light_;
    GroundRow ground_;
    RobotState over_ground_;  // when it last looked
    std::array<double, kGroundSensors> greys_{}, greys_to_sample_{};
    std::optional<double> felt_ground_;
    DelayLine<kGroundSensors> late_greys_;
    DelayLine<1> late_speed_;
    double acceleration_ = 0.0;  // m/s2 forward, over the control period; kept where it tilts the ground row
    RandomStream ground_noise_;
    Accelerometer accelerometer_;
    bool turns_;                                        // an LSM330 asks
    std::optional<std::array<double, 3>> last_angles_;  // rad: roll, pitch, heading
    Ears ears_;
    Battery battery_;
    Channels channels_{};
};

}  // namespace puckloop::physics
