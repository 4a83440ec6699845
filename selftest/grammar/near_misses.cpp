#include "selftest/grammar/near_misses.h"

#include "selftest/grammar/families.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace puckloop::gap::selftest::grammar {

namespace {

using How = Site::How;

/// An effect of the catalogue in its elementary form: what is changed in proportion to covariate^exponent.
struct Elementary {
    const char* kind;
    const char* effect;
    How how;
    const char* column;
    const char* covariate;
    double exponent;
};

constexpr std::array kElementary{
    Elementary{"motion", "load_creep", How::BothWheels, "", "load_kg", 1},
    Elementary{"motion", "heading_drift", How::Plus, "theta_rad", "t_s", 1},
    Elementary{"motion", "step_loss", How::BothWheels, "", "speed", 4},
    Elementary{"motion", "acceleration_slip", How::BothWheels, "", "acceleration", 2},
    Elementary{"motion", "turn_scrub", How::Heading, "", "turn rate", 1},
    Elementary{"proximity", "warm_up", How::Times, "reading", "t_s", 1},
    Elementary{"proximity", "battery_droop", How::Times, "reading", "battery_v", 1},
    Elementary{"proximity", "slow_drift", How::Times, "reading", "order", 1},
    Elementary{"proximity", "incidence", How::Times, "reading", "angle_rad", 2},
    Elementary{"proximity", "saturation", How::Times, "reading", "level", 1},
    Elementary{"proximity", "reference_sag", How::Times, "reading", "motor_speed", 1},
    Elementary{"proximity", "crosstalk", How::Plus, "reading", "pair_reading", 1},
    Elementary{"proximity", "stale_readings", How::Plus, "reading", "velocity", 1},
    Elementary{"proximity", "ambient_light", How::Times, "reading", "ambient", 1},
    Elementary{"ground", "ground_gain", How::Times, "reading", "grey", 0.1},
    Elementary{"ground", "ground_height", How::Times, "reading", "pitch_rad", 1},
    Elementary{"ground", "ground_lag", How::Plus, "reading", "grey_rate", 1},
    Elementary{"ground", "warm_up", How::Times, "reading", "t_s", 1},
    Elementary{"microphone", "microphone_fall", How::Times, "level", "distance_m", 1},
    Elementary{"microphone", "microphone_directivity", How::Times, "level", "angle_rad", 2},
    Elementary{"microphone", "microphone_window", How::Times, "level", "window", 0.5},
    Elementary{"microphone", "warm_up", How::Times, "level", "t_s", 1},
    Elementary{"accelerometer", "accelerometer_scale", How::Plus, "az", "pitch_rad", 2},
    Elementary{"accelerometer", "warm_up", How::Plus, "ax", "t_s", 1},
    Elementary{"accelerometer", "accelerometer_bias", How::Plus, "ay", "motor_speed", 0.1},
    Elementary{"rab", "rab_strength_scale", How::Times, "light", "distance_m", 0.1},
    Elementary{"rab", "rab_lobe", How::Times, "light", "true_bearing_rad", 1},
    Elementary{"rab", "bearing_offset", How::Plus, "bearing_rad", "true_bearing_rad", 0.1},
    Elementary{"rab", "collision_loss", How::Lost, "received", "arrival_rate", 1},
    Elementary{"timing", "i2c_stretch", How::Plus, "t_host_s", "i2c_reads", 1},
    Elementary{"timing", "long_period", How::Plus, "t_host_s", "bytes", 1},
    Elementary{"timing", "clock_drift", How::Plus, "t_host_s", "t_robot_s", 1},
    Elementary{"timing", "baud_mismatch", How::Lost, "frame_ok", "edges", 1},
    Elementary{"timing", "fifo_overrun", How::Lost, "frame_ok", "load", 1}};

constexpr std::array kExponents{0.5, 1.0, 2.0, 3.0};

}  // namespace

NearMiss drawn_near_miss(const WrittenExperiment& exact, RandomStream& random) {
    const auto covariates = covariates_of(exact);
    const auto named = [&](const std::string& name) {
        return std::find_if(covariates.begin(), covariates.end(),
                            [&](const Covariate& one) { return one.name == name; });
    };
    std::vector<Elementary> own;
    for (const Elementary& one : kElementary)
        if (exact.kind == one.kind && named(one.covariate) != covariates.end()) own.push_back(one);
    const Elementary form = own[random.below(own.size())];
    double unit = 1.0;
    for (const Site& site : sites_of(exact.kind))
        if (site.column == form.column && site.how == form.how) unit = site.unit;
    NearMiss miss{{form.how, form.column, unit}, {}, {}, std::string(family_of(form.effect))};
    if (random.uniform() < 0.5) {
        double exponent = form.exponent;
        while (exponent == form.exponent)
            exponent = kExponents[random.below(kExponents.size())];
        miss.field = power_of(*named(form.covariate), exponent);
    } else {
        std::size_t other = random.below(covariates.size());
        while (covariates[other].name == form.covariate)
            other = random.below(covariates.size());
        miss.field = power_of(covariates[other], form.exponent);
    }
    miss.text = fmt::format("near {}: {}", form.effect, miss.site.text() + miss.field.text);
    return miss;
}

}  // namespace puckloop::gap::selftest::grammar
