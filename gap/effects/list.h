#pragma once
// One function an effect, one file each; catalogue.cpp puts them in order.

#include "gap/effects/effect.h"

namespace puckloop::gap {

Effect wheel_scale();
Effect wheel_mismatch();
Effect axle_length();
Effect turn_scrub();
Effect acceleration_slip();
Effect load_creep();
Effect step_loss();
Effect deadband();
Effect backlash();
Effect command_latency();
Effect command_loss();
Effect floor_tilt();
Effect collision_push();
Effect marker_offset();
Effect tracker_delay();
Effect heading_drift();
Effect sensor_gain();
Effect sensor_offset();
Effect response_law();
Effect saturation();
Effect ambient_light();
Effect flicker();
Effect pulsed_interference();
Effect crosstalk();
Effect reflectivity();
Effect incidence();
Effect sensor_direction();
Effect motor_noise();
Effect reference_sag();
Effect stale_readings();
Effect warm_up();
Effect dead_zone();
Effect proportional_noise();
Effect battery_droop();
Effect slow_drift();
Effect ground_gain();
Effect ground_height();
Effect ground_position();
Effect ground_lag();
Effect accelerometer_bias();
Effect accelerometer_scale();
Effect accelerometer_session();
Effect vibration();
Effect microphone_gain();
Effect microphone_self_noise();
Effect microphone_fall();
Effect microphone_directivity();
Effect microphone_window();
Effect strength_spread_parts();
Effect range_noise();
Effect far_floor();
Effect strength_saturation();
Effect multipath();
Effect collision_loss();
Effect random_loss();
Effect poll_loss();
Effect beat_loss();
Effect bearing_offset();
Effect rab_lobe();
Effect rab_strength_scale();
Effect i2c_stretch();
Effect baud_mismatch();
Effect fifo_overrun();
Effect truncation();
Effect long_period();
Effect clock_drift();
Effect batching();

}  // namespace puckloop::gap
