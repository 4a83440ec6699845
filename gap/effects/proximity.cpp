// Infra-red proximity sensors.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> proximity_effects() {
    return {
        // Emitters, receivers and their alignment differ from part to part. y_i = g_i f(d)
        {
            .name = "sensor_gain",
            .number = 18,
            .title = "the sensors have different gains",
            .parameters = {{"proximity.gain*", 0.05, 5.0, 0.3,
                            "log-normal spread 0.15..0.35; ps0 / ps7 1.08..1.65"}},
            .enters = "proximity.gain",
            .separated_by = "all sensors before the same white wall, and two different surfaces",
        },
        // The idle reading differs from the calibrated one and drifts with temperature. y_i = f(d) + o_i
        {
            .name = "sensor_offset",
            .number = 19,
            .title = "the sensors have other offsets",
            .parameters = {{"proximity.offset*", -500.0, 1000.0, 40.0, "-20..+40 counts"}},
            .enters = "proximity.offset",
            .separated_by = "readings with nothing in reach, in the dark",
        },
        // The effective origin and the exponent of the reflective response differ from the assumed curve.
        // A / (d + d0)^p
        {
            .name = "response_law",
            .number = 20,
            .title = "the answer falls with distance by another law",
            .parameters = {{"proximity.extra_exponent", -1.4, 1.4, 0.3, "p 1.5..2.5"},
                           {"proximity.distance_shift", -0.004, 0.02, 0.003, "d0 3..10 mm"},
                           {"proximity.exponent", 0.8, 3.8, 0.4, "p 1.5..2.5"},
                           {"proximity.origin", 0.001, 0.03, 0.004, "d0 3..10 mm"},
                           {"proximity.amplitude", 1e3, 1e7, 6e5, "A 1.2e5..4.2e5, varies with p"},
                           {"proximity.scale",
                            0.2,
                            4.0,
                            0.3,
                            "A varies by 2 between robots",
                            {},
                            "proximity.amplitude"}},
            .enters = "proximity.exponent, origin, amplitude; extra_exponent, distance_shift and scale on "
                      "the measured table",
            .separated_by = "distances over two decades of counts, saturated and floor readings included",
        },
        // The receiver nears its rail: counts grow slower than light. y = 1 / (1/S + 1/f(d))
        {
            .name = "saturation",
            .number = 21,
            .title = "the answer is compressed near contact",
            .parameters = {{"proximity.compression", 0.0, 0.001, 0.00015, "S 3500..5000 counts", {0.0001}},
                           {"proximity.saturation", 800.0, 10000.0, 1500.0, "S 3500..5000 counts", {3000.0}}},
            .enters = "proximity.compression (any curve), proximity.saturation (curves 1 and 2)",
            .separated_by = "distances below 1 cm in steps of 1 mm",
        },
        // Light adds an offset and noise, and takes gain where the phototransistor nears its rail.
        // y = f(d) (1 - k a) + b a, sd^2 grows with a
        {
            .name = "ambient_light",
            .number = 22,
            .title = "room light changes the readings",
            .parameters = {{"proximity.ambient_offset", -500.0, 500.0, 50.0, "+60..+140 counts"},
                           {"proximity.ambient_gain", -0.3, 0.9, 0.1, "y* = 1 - amb / 4095"},
                           {"proximity.ambient_noise", 0.0, 200.0, 8.0, "sd ~ sqrt(ambient)", {2.0}}},
            .needs = {"ambient"},
            .enters = "proximity.ambient_offset, proximity.ambient_gain, proximity.ambient_noise",
            .separated_by = "every distance once in the dark and once in light",
            .role = EffectRole::Scatter,
        },
        // Mains light swings at 100 Hz and is seen at its alias. y += a sin(2 pi f t + phi) in light
        {
            .name = "flicker",
            .number = 23,
            .title = "lamps flicker",
            .parameters = {{"proximity.flicker", 0.0, 300.0, 15.0, "2..30 counts", {8.0}},
                           {"proximity.flicker_frequency", 0.02, 35.0, 5.0,
                            "alias of 100 Hz; found in the spectrum"}},
            .needs = {"t_s"},
            .enters =
                "proximity.flicker, proximity.flicker_frequency; light.flicker is of the ambient counts",
            .separated_by = "the same stillness in the dark and in light",
        },
        // A range finder, another robot's emitters or a range-and-bearing board falls on the dark or the lit
        // sample. with probability q: y +- c
        {
            .name = "pulsed_interference",
            .number = 24,
            .title = "another pulsed source hits the samples",
            .parameters =
                {{"proximity.interference_rate", 0.0, 0.6, 0.08, "q 0.02..0.2", {0.05}},
                 {"proximity.interference_size", 5.0, 2000.0, 200.0, "tens to hundreds of counts", {100.0}}},
            .enters = "proximity.interference_rate, proximity.interference_size; "
                      "proximity.interference_share of sensors that the data shows sheltered",
            .separated_by = "the same with the other robots switched off",
            .role = EffectRole::Outlier,
        },
        // The pulse of the partner, or of the neighbour, reaches this receiver. y_i += sum_j k_ij y_j
        {
            .name = "crosstalk",
            .number = 25,
            .title = "sensors see their neighbours' light",
            .parameters = {{"proximity.pair_crosstalk", -0.05, 0.4, 0.03, "k .01..0.05"},
                           {"proximity.neighbour_crosstalk", -0.05, 0.4, 0.03, ".02"}},
            .needs = {"pair_reading|neighbour_reading"},
            .enters = "proximity.pair_crosstalk, proximity.neighbour_crosstalk",
            .separated_by = "an object before one sensor only",
        },
        // Material and colour set what comes back, for all sensors alike. factor rho for one object
        {
            .name = "reflectivity",
            .number = 26,
            .title = "a surface reflects otherwise than assumed",
            .parameters = {{"object.reflectivity*|proximity.scale", 0.02, 3.0, 0.3,
                            ".05 black .. 1 white .. 1.5 foil; one object: a common factor"}},
            .enters = "reflectivity of the thing in the scenario; proximity.scale with one object",
            .separated_by = "two surfaces before every sensor",
        },
        // Surfaces are not perfectly diffuse; the beam is wide. cos^m(angle)
        {
            .name = "incidence",
            .number = 27,
            .title = "oblique surfaces reflect otherwise",
            .parameters = {{"proximity.incidence_exponent", 0.0, 4.0, 0.5, "m 1..2"}},
            .needs = {"angle_rad"},
            .enters = "proximity.incidence_exponent",
            .separated_by = "a wall turned through both signs of the angle",
        },
        // Bent leads turn a sensor. angle_i + delta_i
        {
            .name = "sensor_direction",
            .number = 28,
            .title = "sensors look in other directions than the drawing says",
            .parameters = {{"proximity.direction*", -3.6, 3.6, 0.08, "+-8 degrees between published tables"}},
            .needs = {"angle_rad"},
            .enters = "proximity.direction",
            .separated_by = "a wall turned through both signs of the angle before each sensor",
        },
        // Supply ripple of the stepping motors. sd (1 + m |v| / 1000)
        {
            .name = "motor_noise",
            .number = 29,
            .title = "running motors make the readings noisy",
            .parameters = {{"proximity.motor_noise", -0.5, 20.0, 1.0, "0.2..1 at 800 steps/s", {0.3}}},
            .needs = {"motor_speed"},
            .enters = "proximity.motor_noise",
            .separated_by = "the same distance with wheels on and off",
            .role = EffectRole::Scatter,
        },
        // Motor current pulls the reference: all channels shrink together. y (1 - r) with motors on
        {
            .name = "reference_sag",
            .number = 31,
            .title = "the converter's reference sags under load",
            .kinds = {Kind::Accelerometer},
            .parameters = {{"proximity.motor_sag", -0.05, 0.3, 0.015, "r 0..2 %"},
                           {"accelerometer.motor_sag", -0.05, 0.3, 0.015, "r 0..2 %"}},
            .needs = {"motor_speed"},
            .enters = "proximity.motor_sag, accelerometer.motor_sag",
            .separated_by = "all channels, with motors on and off at the same place",
        },
        // Sampling schedule and host hold values back. y(t) belongs to t - tau
        {
            .name = "stale_readings",
            .number = 32,
            .title = "readings are older than they look",
            .parameters = {{"proximity.age", -0.02, 0.5, 0.03, "0..15.9 ms plus the host's hold"}},
            .needs = {"velocity"},
            .enters = "proximity.age, less the emulated schedule's own share",
            .separated_by = "approach and retreat at the same speed",
            .fitted_along = true,
        },
        // Temperature changes emitters and amplifiers over minutes. y (1 + k (1 - exp(-t / T)))
        {
            .name = "warm_up",
            .number = 33,
            .title = "the readings drift while the robot warms up",
            .kinds = {Kind::Microphone, Kind::Ground, Kind::Accelerometer},
            .parameters = {{"proximity.warmup_gain", -0.6, 0.6, 0.08, "k -.1..+.1"},
                           {"proximity.warmup_time", 20.0, 2000.0, 250.0, "T 2..10 min"},
                           {"microphone.warmup_gain", -0.8, 0.8, 0.1, "mean rose 290 to 316 in 60 s"},
                           {"microphone.warmup_time", 20.0, 2000.0, 250.0, "?"},
                           {"ground.warmup_gain", -0.6, 0.6, 0.08, "-67..-114 counts in 200 s"},
                           {"ground.warmup_time", 20.0, 2000.0, 250.0, "?"},
                           {"accelerometer.warmup", -500.0, 500.0, 40.0, "?"},
                           {"accelerometer.warmup_time", 20.0, 2000.0, 250.0, "?"}},
            .needs = {"t_s"},
            .enters = "proximity.warmup_gain, proximity.warmup_time, microphone.warmup_gain, "
                      "microphone.warmup_time, ground.warmup_gain, ground.warmup_time, accelerometer.warmup, "
                      "accelerometer.warmup_time",
            .separated_by = "random order of distances, and the first one again at the end",
        },
        // A threshold in the sensor or its software. y = 0 where y < theta
        {
            .name = "dead_zone",
            .number = 34,
            .title = "weak readings are cut to zero",
            .parameters = {{"proximity.threshold", 1.0, 2500.0, 150.0, "1060 on another robot"}},
            .enters = "proximity.threshold",
            .separated_by = "distances in small steps where the reading vanishes",
        },
        // Gain noise beside the converter's. sd = sqrt(a^2 + (b y)^2)
        {
            .name = "proportional_noise",
            .number = 35,
            .title = "noise grows with the reading",
            .parameters = {{"proximity.proportional_noise",
                            0.0,
                            0.6,
                            0.03,
                            "b 0.2-5 % in a published table, about 0 measured",
                            {0.01}}},
            .enters = "proximity.proportional_noise",
            .separated_by = "many repeats at several distances",
            .role = EffectRole::Scatter,
        },
        // Emitter current falls with the voltage. y (1 + k (V - mean))
        {
            .name = "battery_droop",
            .number = 64,
            .title = "readings follow the battery",
            .parameters = {{"proximity.battery_gain", -1.0, 1.0, 0.15, "?"}},
            .needs = {"battery_v"},
            .enters = "proximity.battery_gain",
            .separated_by = "the same with a full and an empty battery",
        },
        // Daylight, people, dust: later runs differ from earlier ones. At which of them the simulator was
        // right nobody knows. y (1 + k (order - order0))
        {
            .name = "slow_drift",
            .number = 66,
            .title = "the world changes between the runs",
            .parameters = {{"proximity.order_drift", -0.2, 0.2, 0.02, "?"},
                           {"proximity.order_zero", -2.0, 2.0, 0.5,
                            "order0 from the rows' mean, in halves of the runs' range: within it, or soon "
                            "before or after"}},
            .needs = {"order"},
            .enters =
                "measuring chain: the runs' order; a scenario's run is one in the middle (proximity.scale)",
            .separated_by = "random order over several days",
        },
    };
}

}  // namespace puckloop::gap
