#include "selftest/grammar/families.h"

#include <array>
#include <span>

namespace puckloop::gap::selftest::grammar {

namespace {

using Names = std::span<const std::string_view>;

constexpr std::string_view kWheels[] = {"wheel_scale", "wheel_mismatch", "axle_length", "turn_scrub"};
constexpr std::string_view kTraction[] = {"acceleration_slip", "load_creep", "step_loss", "deadband",
                                          "backlash"};
constexpr std::string_view kCommands[] = {"command_latency", "command_loss"};
constexpr std::string_view kFloor[] = {"floor_tilt", "collision_push"};
constexpr std::string_view kTracker[] = {"marker_offset", "tracker_delay", "heading_drift"};
constexpr std::string_view kChannel[] = {"sensor_gain", "sensor_offset", "response_law",   "saturation",
                                         "dead_zone",   "ground_gain",   "microphone_gain"};
constexpr std::string_view kLight[] = {"ambient_light", "flicker", "pulsed_interference", "crosstalk"};
constexpr std::string_view kSurface[] = {"reflectivity", "incidence", "sensor_direction", "stale_readings"};
constexpr std::string_view kSlowly[] = {"warm_up", "battery_droop", "slow_drift", "reference_sag",
                                        "accelerometer_session"};
constexpr std::string_view kScatter[] = {"motor_noise", "proportional_noise",
                                         "vibration",   "microphone_self_noise",
                                         "range_noise", "strength_spread_parts"};
constexpr std::string_view kMounting[] = {"ground_height", "ground_position", "ground_lag"};
constexpr std::string_view kAxes[] = {"accelerometer_bias", "accelerometer_scale"};
constexpr std::string_view kSound[] = {"microphone_fall", "microphone_directivity", "microphone_window"};
constexpr std::string_view kStrength[] = {"rab_lobe", "far_floor", "strength_saturation", "multipath",
                                          "rab_strength_scale"};
constexpr std::string_view kBearing[] = {"bearing_offset"};
constexpr std::string_view kLoss[] = {"collision_loss", "random_loss",  "poll_loss", "beat_loss",
                                      "baud_mismatch",  "fifo_overrun", "truncation"};
constexpr std::string_view kPeriod[] = {"i2c_stretch", "long_period", "clock_drift", "batching",
                                        "late_answers"};

struct Family {
    std::string_view name;
    Names members;
};

constexpr std::array kFamilies{
    Family{"wheels", kWheels},   Family{"traction", kTraction}, Family{"commands", kCommands},
    Family{"floor", kFloor},     Family{"tracker", kTracker},   Family{"channel", kChannel},
    Family{"light", kLight},     Family{"surface", kSurface},   Family{"slowly", kSlowly},
    Family{"scatter", kScatter}, Family{"mounting", kMounting}, Family{"axes", kAxes},
    Family{"sound", kSound},     Family{"strength", kStrength}, Family{"bearing", kBearing},
    Family{"loss", kLoss},       Family{"period", kPeriod}};

}  // namespace

std::string_view family_of(std::string_view effect) {
    for (const Family& family : kFamilies)
        for (const std::string_view member : family.members)
            if (member == effect) return family.name;
    return {};
}

}  // namespace puckloop::gap::selftest::grammar
