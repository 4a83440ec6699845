#include "gap/effects/effect.h"
#include "gap/effects/list.h"

#include <algorithm>
#include <string_view>

namespace puckloop::gap {

std::span<const Effect> catalogue() {
    static const std::vector<Effect> all{
        wheel_scale(),
        wheel_mismatch(),
        axle_length(),
        turn_scrub(),
        acceleration_slip(),
        load_creep(),
        step_loss(),
        deadband(),
        backlash(),
        command_latency(),
        command_loss(),
        floor_tilt(),
        collision_push(),
        marker_offset(),
        tracker_delay(),
        heading_drift(),
        sensor_gain(),
        sensor_offset(),
        response_law(),
        saturation(),
        ambient_light(),
        flicker(),
        pulsed_interference(),
        crosstalk(),
        reflectivity(),
        incidence(),
        sensor_direction(),
        motor_noise(),
        reference_sag(),
        stale_readings(),
        warm_up(),
        dead_zone(),
        proportional_noise(),
        battery_droop(),
        slow_drift(),
        ground_gain(),
        ground_height(),
        ground_position(),
        ground_lag(),
        accelerometer_bias(),
        accelerometer_scale(),
        accelerometer_session(),
        vibration(),
        microphone_gain(),
        microphone_self_noise(),
        microphone_fall(),
        microphone_directivity(),
        microphone_window(),
        strength_spread_parts(),
        rab_lobe(),
        range_noise(),
        far_floor(),
        strength_saturation(),
        multipath(),
        collision_loss(),
        random_loss(),
        poll_loss(),
        beat_loss(),
        bearing_offset(),
        rab_strength_scale(),
        i2c_stretch(),
        baud_mismatch(),
        fifo_overrun(),
        truncation(),
        long_period(),
        clock_drift(),
        batching(),
    };
    return all;
}

const Effect* find_effect(std::string_view name) {
    for (const Effect& effect : catalogue())
        if (effect.name == name) return &effect;
    return nullptr;
}

std::vector<const Effect*> effects_of(Kind kind) {
    std::vector<const Effect*> found;
    for (const Effect& effect : catalogue())
        if (std::find(effect.kinds.begin(), effect.kinds.end(), kind) != effect.kinds.end())
            found.push_back(&effect);
    return found;
}

}  // namespace puckloop::gap
