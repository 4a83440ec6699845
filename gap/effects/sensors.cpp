// Floor sensors, accelerometer, microphones.

#include "gap/effects/effect.h"

namespace puckloop::gap {

using enum EffectRole;

// clang-format off
std::vector<Effect> ground_effects() {
    return {
        // Parts and their height differ from robot to robot. y = o_i + g_i f(grey)
        {"ground_gain", 36, "the ground sensors have other gains and offsets",
         {{"ground.gain*", 0.1, 3.0, 0.2, "black 81..677 between 30 robots"},
          {"ground.offset*", -500.0, 500.0, 60.0, "as gain"}},
         "ground.gain, ground.offset", "black and white paper under each sensor"},
        // The nose lifts when the robot accelerates; or the board sits higher than drawn.
        // signal (1 - s lift)
        {"ground_height", 37, "the board's height or tilt changes the readings",
         {{"ground.acceleration_tilt", -1.0, 1.0, 0.05, "correlates with acceleration"},
          {"ground.raised", -0.01, 0.01, 0.002, "1-2 mm"}},
         "ground.height, ground.acceleration_tilt", "starts and stops on one plain grey", {"acceleration"}},
        // The board is mounted further ahead or aside. grey at x + dx
        {"ground_position", 38, "the ground sensors stand elsewhere than drawn",
         {{"ground.forward_error", -0.05, 0.05, 0.005, "edges shift with heading"},
          {"ground.left_error", -0.02, 0.02, 0.004, "?"}},
         "ground.x, ground.y", "an edge crossed at two speeds and in both directions", {"grey_rate"}},
        // Sampling and transport hold the reading back. grey where the robot was tau ago
        {"ground_lag", 38, "the ground sensors answer late",
         {{"ground.lag", -0.05, 1.0, 0.1, "18 of 37 samples of pitch"}},
         "ground.lag, less the emulated board's and host's own share",
         "an edge crossed at two speeds and in both directions", {"grey_rate"}},
    };
}

std::vector<Effect> accelerometer_effects() {
    return {
        // Parts differ; the boot calibration took a tilt for level. zero + b
        {"accelerometer_bias", 39, "the accelerometer has another zero",
         {{"accelerometer.bias*", -900.0, 900.0, 60.0, "accX -223 against -17 between sessions"}},
         "accelerometer.bias", "turn the robot upside down"},
        // Sensitivity differs by axis; the chip is turned on its board. gain_i R(turn) a
        {"accelerometer_scale", 39, "the accelerometer's scale or axes are off",
         {{"accelerometer.scale*", 0.5, 1.6, 0.06, "744-800 counts a g"},
          {"accelerometer.turn", -0.6, 0.6, 0.1, "?"}},
         "accelerometer.scale, accelerometer.turn", "all six faces down"},
        // It is calibrated at power-up, on whatever the robot stands. zero + b_session
        {"accelerometer_session", 39, "the accelerometer's zero jumps between sessions",
         {{"accelerometer.session_bias*", -900.0, 900.0, 80.0, "accX -223 against -17, gyroX -41 against -577"}},
         "measuring chain: the sessions; a scenario's run has their mean (accelerometer.bias)",
         "switch the robot off and on where it stands", {"session"}},
        // Stepping motors and gears. sd^2 + (k v)^2
        {"vibration", 40, "driving shakes the accelerometer",
         {{"accelerometer.vibration", 0.0, 1000.0, 60.0, "gyroZ sd 640 while driving", {15.0}}},
         "accelerometer.vibration", "wheels in the air at several speeds", {"motor_speed"}, Scatter},
    };
}

std::vector<Effect> microphone_effects() {
    return {
        // Parts and housings differ. level_m = g_m level
        {"microphone_gain", 41, "the microphones have different gains",
         {{"microphone.gain*", 0.1, 5.0, 0.2, "+-8 %"}},
         "microphone.gain", "one sound on the axis of each microphone in turn"},
        // Amplifier noise and motors set a floor. level + n + m |v| / 1000
        {"microphone_self_noise", 41, "the microphones hear the robot itself",
         {{"microphone.self_noise", -20.0, 300.0, 15.0, "idle 8-10 counts"},
          {"microphone.motor_noise", -20.0, 300.0, 15.0, "9-15 with motors"}},
         "microphone.self_noise, microphone.motor_noise", "silence, with motors on and off", {}, Scatter},
        // Walls reflect; the field is not free. level ~ d^-p
        {"microphone_fall", 41, "sound falls with distance by another law",
         {{"microphone.exponent", 0.2, 2.5, 0.2, "p 1.16 in a room"}},
         "microphone.exponent", "distances over a decade, outdoors and in a room"},
        // Housing and body shade the sound. level (1 + D cos(angle))
        {"microphone_directivity", 41, "the microphones hear better from one side",
         {{"microphone.directivity", -0.5, 1.5, 0.2, "D 0.3"}},
         "microphone.directivity", "turn the robot before a steady sound", {"angle_rad"}},
        // Largest minus smallest of a window grows with its length. level ~ sqrt(ln N)
        {"microphone_window", 42, "the level is taken from fewer samples",
         {{"microphone.window_lost", -0.5, 0.97, 0.3, "level ~ sqrt(2 ln N)", {0.3}}},
         "microphone.window_lost: samples that the board holds", "two window lengths on the same sound",
         {"window"}},
    };
}
// clang-format on

}  // namespace puckloop::gap
