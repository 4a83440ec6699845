#include "selftest/emulate/secrets.h"

#include "base/random.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace puckloop::gap::emulate {

namespace {

constexpr double kRadius = physics::kWheelRadius, kAxle = physics::kAxleLength;
constexpr int kUnknownsOfAKind = 4;

Secret nothing(const char* kind) {
    return {kind, "nothing", {}, {}, {}};
}

/// One parameter, one draw.
Secret one(const char* kind, const char* what, const char* parameter, double base, double scale,
           const Draw& draw, std::vector<std::string> names) {
    return {kind, what, {draw}, {{parameter, 0, base, scale}}, std::move(names)};
}

Secret one_of(int choices, int closed, Secret secret) {
    secret.choices = choices;
    secret.closed_choice = closed;
    return secret;
}

std::vector<Secret> motion() {
    return {
        nothing("motion"),
        {"motion",
         "wheels larger or smaller",
         {{0.006, 0.003, 0.03, true, "-3..+3 %"}},
         {{"robot.wheel_radius_left", 0, kRadius, kRadius},
          {"robot.wheel_radius_right", 0, kRadius, kRadius}},
         {"wheel_scale"}},
        {"motion",
         "one wheel larger, the other smaller",
         {{0.005, 0.001, 0.01, true, "0..1 %"}},
         {{"robot.wheel_radius_left", 0, kRadius, -kRadius},
          {"robot.wheel_radius_right", 0, kRadius, kRadius}},
         {"wheel_mismatch"}},
        one("motion", "another axle", "robot.axle_length", kAxle, kAxle,
            {0.02, 0.005, 0.04, true, "-4..+4 %"}, {"axle_length"}),
        one("motion", "play in the gears", "robot.backlash", 0, 1,
            {0.052, 0.01, 0.1, false, "0.5..6 degrees"}, {"backlash"}),
        {"motion",
         "slippery floor",
         {{0.06, 0.05, 0.2, false, "mu 0.05..0.8"}},
         {{"contact.mu", 0, 0, 1}, {"contact.mu_lateral", 0, 0, 1}},
         {"acceleration_slip"}},
        {"motion",
         "steps lost at speed",
         {{850, 700, 950, false, "700..1000 steps/s"}, {40, 30, 100, false, "30..100 steps/s"}},
         {{"robot.step_loss_speed", 0, 0, 1}, {"robot.step_loss_width", 1, 0, 1}},
         {"step_loss"}},
        one("motion", "tyres scrub", "robot.turn_scrub", 0, 1, {0.04, 0.01, 0.04, false, "0..4 %"},
            {"turn_scrub"}),
        one("motion", "distance lost under load", "robot.load_creep", 0, 1,
            {0.1, 0.03, 0.15, false, "0..3 % at 0.2 kg"}, {"load_creep"}),
        one("motion", "distance lost on a slope", "robot.slope_creep", 0, 1, {0.2, 0.1, 0.3, false, "0..3 %"},
            {"load_creep"}),
        one("motion", "slow steps do nothing", "robot.deadband", 0, 1,
            {60, 25, 150, false, "0..20 % of the range"}, {"deadband"}),
        {"motion",
         "pulled aside",
         {{0.002, 0.0007, 0.003, true, "mm/s"}, {-0.0015, 0.0007, 0.003, true, "mm/s"}},
         {{"robot.drift_x", 0, 0, 1}, {"robot.drift_y", 1, 0, 1}},
         {"floor_tilt"}},
        {"motion",
         "disturbed now and then",
         {{0.05, 0.03, 0.08, false, "rare"}, {0.02, 0.01, 0.03, false, "mm to cm"}},
         {{"push.rate", 0, 0, 1}, {"push.size", 1, 0, 1}},
         {"collision_push"}},
        one("motion", "commands late on the serial line", "uart.delay", 0, 1,
            {0.04, 0.015, 0.04, false, "20..150 ms; more and no exchange is done in time"},
            {"command_latency"}),
    };
}

std::vector<Secret> proximity() {
    return {
        nothing("proximity"),
        one_of(8, 3,
               one("proximity", "one sensor's gain", "proximity.gain*", 1, 1,
                   {0.2, 0.1, 0.4, true, "spread 0.15..0.35"}, {"sensor_gain"})),
        one("proximity", "one sensor's offset", "proximity.offset5", 63, 1,
            {20, 10, 40, false, "-20..+40 counts"}, {"sensor_offset"}),
        one("proximity", "crosstalk between neighbours", "proximity.neighbour_crosstalk", 0, 1,
            {0.04, 0.015, 0.05, false, "1..5 %"}, {"crosstalk"}),
        one("proximity", "one sensor turned", "proximity.direction1", -0.8011, 1,
            {0.1047, 0.05, 0.15, true, "3..9 degrees"}, {"sensor_direction"}),
        one("proximity", "emitters weaker or stronger", "proximity.scale", 1, 1,
            {-0.1, 0.05, 0.4, true, "a factor of two between robots"}, {"sensor_gain", "reflectivity"}),
        one("proximity", "noise in proportion to the reading", "proximity.proportional_noise", 0, 1,
            {0.05, 0.02, 0.05, false, "0.2..5 %"}, {"proportional_noise"}),
        one("proximity", "noise of room light", "proximity.ambient_noise", 0, 1,
            {12, 8, 25, false, "root of the ambient counts"}, {"ambient_light"}),
        {"proximity",
         "foreign pulses",
         {{0.08, 0.03, 0.15, false, "rare"}, {150, 100, 300, false, "counts"}},
         {{"proximity.interference_rate", 0, 0, 1}, {"proximity.interference_size", 1, 0, 1}},
         {"pulsed_interference"}},
        {"proximity",
         "warms up",
         {{0.2, 0.08, 0.3, true, "10 % and more"}, {20, 10, 40, false, "s"}},
         {{"proximity.warmup_gain", 0, 0, 1}, {"proximity.warmup_time", 1, 0, 1}},
         {"warm_up"}},
        {"proximity",
         "lamps flicker",
         {{15, 8, 30, false, "2..30 counts"}, {2.3, 0.5, 4.5, false, "alias of 100 Hz"}},
         {{"proximity.flicker", 0, 0, 1}, {"proximity.flicker_frequency", 1, 0, 1}},
         {"flicker"}},
        one("proximity", "noise of the motors", "proximity.motor_noise", 0, 1,
            {4, 1.5, 6, false, "0.2..1 at 800 steps/s"}, {"motor_noise"}),
        one("proximity", "old readings", "proximity.age", 0, 1,
            {0.06, 0.03, 0.12, false, "16 ms and the host's hold"}, {"stale_readings"}),
    };
}

std::vector<Secret> other_sensors() {
    return {
        nothing("ground"),
        one_of(3, 1,
               one("ground", "one sensor's gain", "ground.gain*", 1, 1,
                   {-0.08, 0.05, 0.3, true, "81..677 black"}, {"ground_gain"})),
        one_of(3, 0,
               one("ground", "one sensor's offset", "ground.offset*", 0, 1, {25, 15, 80, false, "as gain"},
                   {"ground_gain"})),
        one("ground", "black is another", "ground.black", 0, 1, {400, 360, 500, false, "81..677"},
            {"ground_gain"}),
        {"ground",
         "warms up",
         {{-0.15, 0.08, 0.3, true, "-67..-114 counts"}, {20, 10, 40, false, "s"}},
         {{"ground.warmup_gain", 0, 0, 1}, {"ground.warmup_time", 1, 0, 1}},
         {"warm_up"}},
        one("ground", "late readings", "ground.lag", 0, 1,
            {0.06, 0.03, 0.2, false, "18 of 37 samples of pitch"}, {"ground_lag"}),
        nothing("microphone"),
        one_of(3, 1,
               one("microphone", "one microphone's gain", "microphone.gain*", 1, 1,
                   {0.2, 0.08, 0.3, true, "8 %"}, {"microphone_gain"})),
        one("microphone", "sound falls otherwise", "microphone.exponent", 1, 1,
            {0.16, 0.1, 0.35, true, "1.16 in a room"}, {"microphone_fall"}),
        one("microphone", "directed microphones", "microphone.directivity", 0, 1,
            {0.3, 0.15, 0.5, false, "0.3"}, {"microphone_directivity"}),
        one("microphone", "noise of its own", "microphone.self_noise", 0, 1,
            {40, 20, 60, false, "8..10 counts"}, {"microphone_self_noise"}),
        one("microphone", "noise of the motors", "microphone.motor_noise", 0, 1,
            {100, 40, 150, false, "9..15 counts"}, {"microphone_self_noise"}),
        nothing("accelerometer"),
        one_of(3, 0,
               one("accelerometer", "one axis' zero", "accelerometer.bias*", 0, 1,
                   {30, 15, 80, true, "-17..-223 counts"}, {"accelerometer_bias"})),
    };
}

std::vector<Secret> links() {
    return {
        nothing("timing"),
        one("timing", "another control period", "host.period", 0.1, 1,
            {0.004, 0.001, 0.008, true, "104 ms typical"}, {"long_period", "clock_drift"}),
        one("timing", "bytes lost", "uart.loss", 0, 1, {0.00033, 0.0002, 0.001, false, "1e-4..1e-2 a frame"},
            {"truncation"}),
        {"timing",
         "answers cut, in bursts",
         {{0.04, 0.01, 0.06, false, "bursts"}, {0.3, 0.1, 0.7, false, "bursts"}},
         {{"uart.cut", 0, 0, 1}, {"uart.cut_again", 1, 0, 1}},
         {"truncation"}},
        one("timing", "bytes handed on in batches", "linux.tty_batch", 0, 1,
            {0.012, 0.006, 0.04, false, "5..50 ms"}, {"batching", "late_answers"}),
        one("timing", "the I2C bus is held", "linux.i2c_hold", 0, 1, {0.0015, 0.001, 0.005, false, "1..5 ms"},
            {"i2c_stretch"}),
        nothing("rab"),
        one_of(12, 3,
               one("rab", "one receiver's gain", "ir.receiver_gain*", 1, 1,
                   {0.3, 0.15, 0.5, true, "spread 0.1..0.3"}, {"strength_spread_parts"})),
        one("rab", "emitters' lobe", "ir.emitter_exponent", 1, 1, {1, 0.5, 1.5, false, "cos to cos^2.5"},
            {"rab_lobe"}),
        one("rab", "receivers' lobe", "ir.receiver_exponent", 0.5, 1,
            {0.5, 0.3, 1, false, "root of cos to cos^1.5"}, {"rab_lobe"}),
        one("rab", "boards polled seldom", "host.rab_poll", 0, 1, {0.06, 0.04, 0.1, false, "20 ms and more"},
            {"poll_loss"}),
        {"rab",
         "frames lost in bursts",
         {{0.12, 0.06, 0.2, false, "1..5 % and more"}, {0.3, 0.15, 1, false, "s"}},
         {{"ir.spell", 0, 0, 1}, {"ir.spell_time", 1, 0, 1}},
         {"beat_loss"}},
        one("rab", "frames by reflection", "ir.stray", 0, 1, {0.1, 0.05, 0.2, false, "5..20 %"},
            {"multipath"}),
        nothing("serial"),
        one("serial", "main board's crystal off", "board.crystal_ppm", 0, 1,
            {-120, 60, 300, true, "50 ppm and more"}, {"clock_drift"}),
        one("serial", "no crystal", "board.crystal_ppm", 0, 1, {6000, 3000, 9000, true, "1..2 %"},
            {"clock_drift"}),
    };
}

std::string with_number(const char* parameter, int number) {
    std::string name = parameter;
    if (name.ends_with('*')) name.replace(name.size() - 1, 1, std::to_string(number));
    return name;
}

std::vector<std::string> assigned(const Secret& secret, const std::vector<double>& draws, int choice) {
    std::vector<std::string> list;
    for (const Setting& setting : secret.settings)
        list.push_back(fmt::format("{}={:.9g}", with_number(setting.parameter, choice),
                                   setting.base + setting.scale * draws[setting.draw]));
    return list;
}

}  // namespace

const std::vector<Secret>& secrets() {
    static const std::vector<Secret> list = [] {
        std::vector<Secret> all;
        for (const auto& part : {motion(), proximity(), other_sensors(), links()})
            all.insert(all.end(), part.begin(), part.end());
        for (const char* kind : {"motion", "proximity", "ground", "microphone", "accelerometer"})
            for (int k = 0; k < kUnknownsOfAKind; ++k) {
                Secret unknown = nothing(kind);
                unknown.what = "something beyond the catalogue";
                unknown.unknown = true;
                all.push_back(std::move(unknown));
            }
        return all;
    }();
    return list;
}

std::vector<std::string> drawn_assignments(const Secret& secret, std::size_t number, std::uint64_t seed) {
    RandomStream random(seed, fmt::format("secret {}", number));
    std::vector<double> draws;
    for (const Draw& draw : secret.draws) {
        const double size = draw.low + (draw.high - draw.low) * random.uniform();
        draws.push_back(draw.both && random.uniform() < 0.5 ? -size : size);
    }
    const int choice =
        static_cast<int>(random.below(static_cast<std::uint64_t>(std::max(secret.choices, 1))));
    return assigned(secret, draws, choice);
}

std::vector<std::string> closed_assignments(const Secret& secret) {
    std::vector<double> draws;
    for (const Draw& draw : secret.draws)
        draws.push_back(draw.closed);
    return assigned(secret, draws, secret.closed_choice);
}

}  // namespace puckloop::gap::emulate
