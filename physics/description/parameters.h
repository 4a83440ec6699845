#pragma once
// Every number of the world model: named, with unit, default, range and source, in one table, and settable by
// name from a scenario or an overlay. Sources are given with each entry of parameter_table.cpp.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

inline constexpr int kProximitySensors = 8;
inline constexpr int kGroundSensors = 3;
inline constexpr int kMicrophones = 3;
/// Emitters, and receivers, of a range-and-bearing board; index 0 is hardware number 1.
inline constexpr int kIrSensors = 12;
/// Distances at which the board's strength was measured.
inline constexpr int kIrCurvePoints = 9;

/// Body and drive of one robot. SI units; steps are motor steps, 1000 a wheel turn.
struct BodyParameters {
    double radius, height, mass, com_x, com_z, inertia_x, inertia_y, inertia_z, reflectivity;
    double wheel_radius_left, wheel_radius_right, axle_length, wheel_mass;
    double skid_distance, skid_clearance, pitch_damping;
    double steps_per_turn, stall_torque, drive_compliance, settle_time, smoothing_limit, pull_out_steps;
    double backlash, step_loss_speed, step_loss_width, deadband;
    double load, turn_scrub, load_creep, slope_creep, drift_x, drift_y;
};

/// Reflective infra-red sensors, clockwise from front right.
struct ProximityParameters {
    std::array<double, kProximitySensors> gain, offset, x, y, direction, interference_share;
    double height, curve, amplitude, origin, exponent, saturation, scale, reach;
    double rays, aperture, incidence_exponent;
    double pair_crosstalk, neighbour_crosstalk, warmup_gain, warmup_time;
    double compression, extra_exponent, distance_shift, threshold, ambient_offset, ambient_gain, battery_gain,
        motor_sag;
    double age, flicker, flicker_frequency, interference_rate, interference_size;
    double still_noise, motor_noise, proportional_noise, ambient_noise;
};

/// Ambient light at the same eight places.
struct LightParameters {
    std::array<double, kProximitySensors> gain, offset;
    double dark, span, room, decay, range, flicker, flicker_frequency;
};

/// Ground sensors: left, centre, right.
struct GroundParameters {
    std::array<double, kGroundSensors> gain, offset, y;
    double x, height, black, white, saturation, height_slope, footprint, ambient;
    double noise, period, lag, acceleration_tilt, warmup_gain, warmup_time;
};

/// Three-axis accelerometer; arrays are x (right), y (rear), z (up).
struct AccelerometerParameters {
    std::array<double, 3> bias, scale;
    double zero, gain, bandwidth, turn, motor_sag, vibration, warmup, warmup_time;
};

/// Pushes that move a robot without its wheels, now and then.
struct PushParameters {
    double rate, size, turn;
};

/// Microphones: right, left, rear.
struct MicrophoneParameters {
    std::array<double, kMicrophones> gain, x, y, direction;
    double height, exponent, directivity, self_noise, motor_noise, window_lost, warmup_gain, warmup_time;
};

struct BatteryParameters {
    double capacity, charge, resistance, idle_power, motor_power, low_voltage;
};

/// Infra-red between range-and-bearing boards. Emission follows the sender's values, everything from the
/// falloff with distance on the receiver's.
struct IrParameters {
    std::array<double, kIrSensors> emitter_angle, emitter_gain, receiver_angle, receiver_gain;
    std::array<double, kIrSensors> demodulator_gain, baseline;
    double ring, height, emitter_exponent, power_reference, power_exponent, power_floor;
    std::array<double, kIrCurvePoints> distance, level;
    double source_offset, receiver_exponent, reach, demodulator_exponent, centre_frequency, quality;
    double threshold, delay_on, delay_off, min_burst, min_gap, level_delay, level_hold, gain_share, gain_hold,
        ambient;
    double emitter_spread, receiver_spread, demodulator_spread;
    double frame_noise, receiver_noise, carrier_noise, near_noise, near_range;
    double reflection, self_coupling, chip, refresh, rail;
    double loss, spell, spell_time, stray, stray_loss;
};

/// Cameras of the Linux board (physics/camera). Lengths in the image are in heights of the image.
struct CameraParameters {
    double height, eccentricity, rim, rim_elevation, centre_x, centre_y;
    double front_x, front_height, front_fov;
    double exposure, noise, ring_level, turret_level, booth_level, crosstalk, ring_radius, turret_radius;
};

/// IRcom: light of proximity diodes between robots, and between a robot and a TAM. `tam_*` are the TAMs', and
/// hold for the whole world.
struct IrcomParameters {
    double power, gain, emitter_exponent, receiver_exponent, reach, delay;
    double tam_power, tam_threshold, tam_time;
};

/// Contacts between any two things; one set for the whole world.
struct ContactParameters {
    double mu, mu_lateral, mu_skid, mu_body, mu_object, creep;
    double erp, cfm, soft_erp, soft_cfm, max_velocity, surface_layer, push_height;
};

struct SimulationParameters {
    double gravity, slope_x, slope_y, publish_quantum;
};

/// All of them. A robot uses its own copy of the robot groups; `contact` and `world` hold for everything.
struct Parameters {
    Parameters();  ///< defaults from the table

    BodyParameters robot;
    PushParameters push;
    ProximityParameters proximity;
    LightParameters light;
    GroundParameters ground;
    AccelerometerParameters accelerometer;
    MicrophoneParameters microphone;
    BatteryParameters battery;
    IrParameters ir;
    CameraParameters camera;
    IrcomParameters ircom;
    ContactParameters contact;
    SimulationParameters world;

    /// Sets `name` ("robot.axle_length", "proximity.gain3"; "proximity.gain" sets all eight). Throws
    /// std::invalid_argument with one line for an unknown name (with the nearest one) or a value out of
    /// range.
    void set(std::string_view name, double value);
    /// Throws std::invalid_argument for an unknown name.
    double get(std::string_view name) const;
};

/// One line of the table; `count` > 1 means name0, name1, ...
struct ParameterInfo {
    const char* name;
    const char* unit;  ///< "m", "rad", "counts", "1", ...
    int count;
    std::vector<double> defaults;  ///< `count` values, or one for all
    double min, max;
    double* (*place)(Parameters&);  ///< first of `count` consecutive values
    const char* source;             ///< where the figure comes from; "?" = plausible, no source

    /// False: `contact.` and `world.`, which a single robot cannot override.
    bool of_robot() const;
};

/// All entries, in the order of documentation.
std::span<const ParameterInfo> parameter_table();

/// The entry that `name` belongs to, or nullptr. `index` is -1 for the bare name of an array.
const ParameterInfo* find_parameter(std::string_view name, int& index);

}  // namespace puckloop::physics
