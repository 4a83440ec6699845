#include "gap/overlay/overlay_names.h"

#include "physics/description/parameters.h"

#include <algorithm>
#include <array>

namespace puckloop::gap {

bool overlay_takes(std::string_view parameter) {
    // Those that the world, the line or the crystals have under another name.
    static constexpr std::array<std::string_view, 28> kOthers{"wheel_scale",
                                                              "wheel_mismatch",
                                                              "inverse_friction",
                                                              "command.latency",
                                                              "command.loss",
                                                              "timing.truncation",
                                                              "timing.clock_drift",
                                                              "ground.forward_error",
                                                              "ground.left_error",
                                                              "ground.raised",
                                                              "rab.strength_gain",
                                                              "rab.far_floor",
                                                              "rab.saturation",
                                                              "rab.strength_spread",
                                                              "rab.bearing_offset",
                                                              "rab.emitter_lobe",
                                                              "rab.receiver_lobe",
                                                              "rab.random_loss",
                                                              "rab.beat",
                                                              "rab.beat_burst",
                                                              "rab.multipath",
                                                              "rab.multipath_loss",
                                                              "timing.truncation_burst",
                                                              "timing.edge_errors",
                                                              "timing.i2c_stretch",
                                                              "timing.batch",
                                                              "timing.extra_period",
                                                              "timing.period_jitter"};
    int index = -1;
    return physics::find_parameter(parameter, index) != nullptr ||
           std::find(kOthers.begin(), kOthers.end(), parameter) != kOthers.end() ||
           parameter.starts_with("rab.receiver_gain") || parameter.starts_with("rab.emitter_gain");
}

}  // namespace puckloop::gap
