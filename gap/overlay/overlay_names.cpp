#include "gap/overlay/overlay_names.h"

#include "physics/description/parameters.h"

#include <set>
#include <string_view>

namespace puckloop::gap {

namespace {

/// Those that the world, the line or the crystals have under another name.
// clang-format off
const std::set<std::string_view> kOthers{
    "wheel_scale", "wheel_mismatch", "inverse_friction",
    "command.latency", "command.loss",
    "ground.forward_error", "ground.left_error", "ground.raised",
    "rab.strength_gain", "rab.far_floor", "rab.saturation", "rab.strength_spread", "rab.bearing_offset",
    "rab.emitter_lobe", "rab.receiver_lobe", "rab.random_loss", "rab.beat", "rab.beat_burst", "rab.multipath",
    "rab.multipath_loss",
    "timing.truncation", "timing.clock_drift", "timing.truncation_burst", "timing.edge_errors",
    "timing.i2c_stretch", "timing.batch", "timing.extra_period", "timing.period_jitter",
};
// clang-format on

}  // namespace

bool overlay_takes(std::string_view parameter) {
    int index = -1;
    return physics::find_parameter(parameter, index) != nullptr || kOthers.contains(parameter) ||
           parameter.starts_with("rab.receiver_gain") || parameter.starts_with("rab.emitter_gain");
}

}  // namespace puckloop::gap
