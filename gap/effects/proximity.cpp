// Infra-red proximity sensors.

#include "gap/effects/effect.h"

namespace puckloop::gap {

using enum EffectRole;

// clang-format off
std::vector<Effect> proximity_effects() {
    return {
        // Emitters, receivers and their alignment differ from part to part. y_i = g_i f(d)
        {"sensor_gain", 18, "the sensors have different gains",
         {{"proximity.gain*", 0.05, 5.0, 0.3, "log-normal spread 0.15..0.35; ps0 / ps7 1.08..1.65"}},
         "proximity.gain", "all sensors before the same white wall, and two different surfaces"},
        // The idle reading differs from the calibrated one and drifts with temperature. y_i = f(d) + o_i
        {"sensor_offset", 19, "the sensors have other offsets",
         {{"proximity.offset*", -500.0, 1000.0, 40.0, "-20..+40 counts"}},
         "proximity.offset", "readings with nothing in reach, in the dark"},
        // The effective origin and the exponent of the reflective response differ from the assumed curve.
        // A / (d + d0)^p
        {"response_law", 20, "the answer falls with distance by another law",
         {{"proximity.extra_exponent", -1.4, 1.4, 0.3, "p 1.5..2.5"},
          {"proximity.distance_shift", -0.004, 0.02, 0.003, "d0 3..10 mm"},
          {"proximity.exponent", 0.8, 3.8, 0.4, "p 1.5..2.5"},
          {"proximity.origin", 0.001, 0.03, 0.004, "d0 3..10 mm"},
          {"proximity.amplitude", 1e3, 1e7, 6e5, "A 1.2e5..4.2e5, varies with p"},
          {"proximity.scale", 0.2, 4.0, 0.3, "A varies by 2 between robots", {}, "proximity.amplitude"}},
         "proximity.exponent, origin, amplitude; extra_exponent, distance_shift and scale on the measured table",
         "distances over two decades of counts, saturated and floor readings included"},
        // The receiver nears its rail: counts grow slower than light. y = 1 / (1/S + 1/f(d))
        {"saturation", 21, "the answer is compressed near contact",
         {{"proximity.compression", 0.0, 0.001, 0.00015, "S 3500..5000 counts", {0.0001}},
          {"proximity.saturation", 800.0, 10000.0, 1500.0, "S 3500..5000 counts", {3000.0}}},
         "proximity.compression (any curve), proximity.saturation (curves 1 and 2)",
         "distances below 1 cm in steps of 1 mm"},
        // Light adds an offset and noise, and takes gain where the phototransistor nears its rail.
        // y = f(d) (1 - k a) + b a, sd^2 grows with a
        {"ambient_light", 22, "room light changes the readings",
         {{"proximity.ambient_offset", -500.0, 500.0, 50.0, "+60..+140 counts"},
          {"proximity.ambient_gain", -0.3, 0.9, 0.1, "y* = 1 - amb / 4095"},
          {"proximity.ambient_noise", 0.0, 200.0, 8.0, "sd ~ sqrt(ambient)", {2.0}}},
         "proximity.ambient_offset, proximity.ambient_gain, proximity.ambient_noise",
         "every distance once in the dark and once in light", {"ambient"}, Scatter},
        // Mains light swings at 100 Hz and is seen at its alias. y += a sin(2 pi f t + phi) in light
        {"flicker", 23, "lamps flicker",
         {{"proximity.flicker", 0.0, 300.0, 15.0, "2..30 counts", {8.0}},
          {"proximity.flicker_frequency", 0.02, 35.0, 5.0, "alias of 100 Hz; found in the spectrum"}},
         "proximity.flicker, proximity.flicker_frequency; light.flicker is of the ambient counts",
         "the same stillness in the dark and in light", {"t_s"}},
        // A range finder, another robot's emitters or a range-and-bearing board falls on the dark or the lit
        // sample. with probability q: y +- c
        {"pulsed_interference", 24, "another pulsed source hits the samples",
         {{"proximity.interference_rate", 0.0, 0.6, 0.08, "q 0.02..0.2", {0.05}},
          {"proximity.interference_size", 5.0, 2000.0, 200.0, "tens to hundreds of counts", {100.0}}},
         "proximity.interference_rate, proximity.interference_size; "
         "proximity.interference_share of sensors that the data shows sheltered",
         "the same with the other robots switched off", {}, Outlier},
        // The pulse of the partner, or of the neighbour, reaches this receiver. y_i += sum_j k_ij y_j
        {"crosstalk", 25, "sensors see their neighbours' light",
         {{"proximity.pair_crosstalk", -0.05, 0.4, 0.03, "k .01..0.05"},
          {"proximity.neighbour_crosstalk", -0.05, 0.4, 0.03, ".02"}},
         "proximity.pair_crosstalk, proximity.neighbour_crosstalk", "an object before one sensor only",
         {"pair_reading|neighbour_reading"}},
        // Material and colour set what comes back, for all sensors alike. factor rho for one object
        {"reflectivity", 26, "a surface reflects otherwise than assumed",
         {{"object.reflectivity*|proximity.scale", 0.02, 3.0, 0.3, ".05 black .. 1 white .. 1.5 foil; one object: a common factor"}},
         "reflectivity of the thing in the scenario; proximity.scale with one object",
         "two surfaces before every sensor"},
        // Surfaces are not perfectly diffuse; the beam is wide. cos^m(angle)
        {"incidence", 27, "oblique surfaces reflect otherwise",
         {{"proximity.incidence_exponent", 0.0, 4.0, 0.5, "m 1..2"}},
         "proximity.incidence_exponent", "a wall turned through both signs of the angle", {"angle_rad"}},
        // Bent leads turn a sensor. angle_i + delta_i
        {"sensor_direction", 28, "sensors look in other directions than the drawing says",
         {{"proximity.direction*", -3.6, 3.6, 0.08, "+-8 degrees between published tables"}},
         "proximity.direction", "a wall turned through both signs of the angle before each sensor",
         {"angle_rad"}},
        // Supply ripple of the stepping motors. sd (1 + m |v| / 1000)
        {"motor_noise", 29, "running motors make the readings noisy",
         {{"proximity.motor_noise", -0.5, 20.0, 1.0, "0.2..1 at 800 steps/s", {0.3}}},
         "proximity.motor_noise", "the same distance with wheels on and off", {"motor_speed"}, Scatter},
        // Motor current pulls the reference: all channels shrink together. y (1 - r) with motors on
        {"reference_sag", 31, "the converter's reference sags under load",
         {{"proximity.motor_sag", -0.05, 0.3, 0.015, "r 0..2 %"},
          {"accelerometer.motor_sag", -0.05, 0.3, 0.015, "r 0..2 %"}},
         "proximity.motor_sag, accelerometer.motor_sag",
         "all channels, with motors on and off at the same place", {"motor_speed"}, Mean, false,
         {Kind::Accelerometer}},
        // Sampling schedule and host hold values back. y(t) belongs to t - tau
        {"stale_readings", 32, "readings are older than they look",
         {{"proximity.age", -0.02, 0.5, 0.03, "0..15.9 ms plus the host's hold"}},
         "proximity.age, less the emulated schedule's own share", "approach and retreat at the same speed",
         {"velocity"}, Mean, true},
        // Temperature changes emitters and amplifiers over minutes. y (1 + k (1 - exp(-t / T)))
        {"warm_up", 33, "the readings drift while the robot warms up",
         {{"proximity.warmup_gain", -0.6, 0.6, 0.08, "k -.1..+.1"},
          {"proximity.warmup_time", 20.0, 2000.0, 250.0, "T 2..10 min"},
          {"microphone.warmup_gain", -0.8, 0.8, 0.1, "mean rose 290 to 316 in 60 s"},
          {"microphone.warmup_time", 20.0, 2000.0, 250.0, "?"},
          {"ground.warmup_gain", -0.6, 0.6, 0.08, "-67..-114 counts in 200 s"},
          {"ground.warmup_time", 20.0, 2000.0, 250.0, "?"},
          {"accelerometer.warmup", -500.0, 500.0, 40.0, "?"},
          {"accelerometer.warmup_time", 20.0, 2000.0, 250.0, "?"}},
         "proximity.warmup_gain, proximity.warmup_time, microphone.warmup_gain, microphone.warmup_time, "
         "ground.warmup_gain, ground.warmup_time, accelerometer.warmup, accelerometer.warmup_time",
         "random order of distances, and the first one again at the end", {"t_s"}, Mean, false,
         {Kind::Microphone, Kind::Ground, Kind::Accelerometer}},
        // A threshold in the sensor or its software. y = 0 where y < theta
        {"dead_zone", 34, "weak readings are cut to zero",
         {{"proximity.threshold", 1.0, 2500.0, 150.0, "1060 on another robot"}},
         "proximity.threshold", "distances in small steps where the reading vanishes"},
        // Gain noise beside the converter's. sd = sqrt(a^2 + (b y)^2)
        {"proportional_noise", 35, "noise grows with the reading",
         {{"proximity.proportional_noise", 0.0, 0.6, 0.03, "b 0.2-5 % in a published table, about 0 measured", {0.01}}},
         "proximity.proportional_noise", "many repeats at several distances", {}, Scatter},
        // Emitter current falls with the voltage. y (1 + k (V - mean))
        {"battery_droop", 64, "readings follow the battery",
         {{"proximity.battery_gain", -1.0, 1.0, 0.15, "?"}},
         "proximity.battery_gain", "the same with a full and an empty battery", {"battery_v"}},
        // Daylight, people, dust: later runs differ from earlier ones. At which of them the simulator was
        // right nobody knows. y (1 + k (order - order0))
        {"slow_drift", 66, "the world changes between the runs",
         {{"proximity.order_drift", -0.2, 0.2, 0.02, "?"},
          {"proximity.order_zero", -2.0, 2.0, 0.5, "order0 from the rows' mean, in halves of the runs' range: "
           "within it, or soon before or after"}},
         "measuring chain: the runs' order; a scenario's run is one in the middle (proximity.scale)",
         "random order over several days", {"order"}},
    };
}
// clang-format on

}  // namespace puckloop::gap
