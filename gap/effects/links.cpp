// Range and bearing, and frames of the control loop.

#include "gap/effects/effect.h"

namespace puckloop::gap {

using enum EffectRole;

// clang-format off
std::vector<Effect> rab_effects() {
    return {
        // Parts and soldering. s_ij = g_i g_j s
        {"strength_spread_parts", 46, "emitters and receivers differ in gain",
         {{"rab.receiver_gain*", 0.2, 4.0, 0.25, "log-normal 0.1..0.3"},
          {"rab.emitter_gain*", 0.2, 4.0, 0.25, "as receivers"}},
         "ir.receiver_gain, ir.emitter_gain",
         "turn the receiver before one fixed emitter, with several pairs of boards", {"+strength"}},
        // Diodes and detectors of another make, or set deeper in the ring. light cos(a)^n, strength cos(b)^m
        {"rab_lobe", 46, "emitters or receivers are more or less directed",
         {{"rab.emitter_lobe", 0.1, 12.0, 0.5, "1: a wide diode; 12: 20 degrees to the half", {2.0}},
          {"rab.receiver_lobe", 0.1, 6.0, 0.25, "0.5: what the board's formula assumes", {1.0}}},
         "ir.emitter_exponent, ir.receiver_exponent", "one emitter at a time, the sender turned", {"+strength"}},
        // Contact, alignment and reflections vary from message to message. sd of ln s (1 + m)
        {"range_noise", 47, "strengths scatter more than the simulator's",
         {{"rab.strength_spread", -0.9, 5.0, 0.5, "0.36 at contact, 0.11-0.15 beyond", {0.2}}},
         "ir.frame_noise, ir.receiver_noise, ir.near_noise",
         "several pairs of boards at one distance, turned", {"+strength"}, Scatter},
        // Background and automatic gain keep far readings above a floor. s = max(s, floor)
        {"far_floor", 48, "far strengths stay up",
         {{"rab.far_floor", 100.0, 3000.0, 400.0, "median 920 beyond 45 cm", {950.0, 1150.0}}},
         "ir.level", "distances beyond half a metre", {"+strength"}},
        // The peak detector reaches its rail. s = min(s, S)
        {"strength_saturation", 49, "near strengths are clipped early",
         {{"rab.saturation", 300.0, 4095.0, 1500.0, "4095; readings fold below 2 cm", {}, nullptr, 0.5}},
         "ir.rail", "distances below 5 cm", {"+strength"}},
        // Another path wins: longer, weaker, from elsewhere. with probability w: ln s - l, bearing scattered
        {"multipath", 51, "messages come by reflections",
         {{"rab.multipath", 0.0, 0.7, 0.08, "w .05..0.2", {0.05}},
          {"rab.multipath_loss", 0.1, 2.5, 0.5, "-3..-10 dB"}},
         "ir.stray, ir.stray_loss, beside the scenario's walls and bodies",
         "the same in the middle of an empty room", {"+strength|bearing_rad"}, Outlier},
        // Boards that do not listen before sending overlap. p_ok = exp(-2 (N - 1) T_frame / T_period)
        {"collision_loss", 52, "frames of several senders collide",
         {{"rab.collisions", 0.0, 2.0, 0.5, "1 for senders that know nothing of each other", {0.3}}},
         "emerges from boards that send", "the same place with one, two and four senders", {"senders", "+received"}},
        // Weak light, interference, interrupts. p_ok = 1 - q
        {"random_loss", 53, "messages are lost whoever sends",
         {{"rab.random_loss", 0.0, 1.0, 0.15, "30 % to 85 % reported", {0.05, 0.5}}},
         "ir.loss, beside the losses that emerge", "one sender only, many messages in a row", {"+received"}},
        // The board's queue overflows. p_ok = min(1, capacity / rate)
        {"poll_loss", 54, "the host polls too slowly",
         {{"rab.fetch_time", 0.0, 0.5, 0.02, "50 messages a second at 20 ms", {0.02, 0.04}}},
         "emerges from the poll period of the Linux program",
         "the same senders with a faster and a slower poll", {"arrival_rate|senders", "+received"}},
        // Two crystals beat: while the edges meet, frames are lost. lost while the phase lies in a window
        {"beat_loss", 55, "losses come in bursts",
         {{"rab.beat", 0.0, 1.0, 0.1, "1-5 % of frames", {0.05}},
          {"rab.beat_burst", 0.01, 20.0, 1.0, "beat 10-60 s", {0.3}}},
         "ir.spell, ir.spell_time, beside what emerges from the crystals", "long records at two temperatures",
         {"t_s", "+received"}},
        // The receiver or the truth's axis is turned. bearing + b
        {"bearing_offset", 15, "bearings are off by a constant",
         {{"rab.bearing_offset", -1.5, 1.5, 0.1, "-2..+8 degrees"}},
         "ir.receiver_angle", "the sender moved round the receiver", {"+bearing_rad"}},
        // Emitter power, window or supply. ln s + g
        {"rab_strength_scale", 26, "all strengths are higher or lower",
         {{"rab.strength_gain", -2.0, 2.0, 0.25, "641 against 1050 counts at 20 cm between robots"}},
         "ir.receiver_gain, all twelve", "a second pair of boards", {"+strength"}},
    };
}

std::vector<Effect> timing_effects() {
    return {
        // Slaves stretch the clock or the bus is shared. + s per transfer
        {"i2c_stretch", 57, "the I2C bus holds the cycle up",
         {{"timing.i2c_stretch", -0.001, 0.05, 0.0015, "1..5 ms", {0.0015}}},
         "the overlay's [linux] i2c_hold, beside what emerges from the emulated bus",
         "the same loop with and without the I2C boards", {"i2c_reads"}},
        // An oscillator is off: bytes with long runs are misread. p(frame wrong) grows with edges
        {"baud_mismatch", 58, "the two ends disagree about the baud rate",
         {{"timing.edge_errors", 0.0, 0.5, 0.01, "0 at 14.7456 MHz; 2.1 % at 16 MHz", {0.005}}},
         "the overlay's [uart] answer_edge_loss", "frames of 0x55 against frames of 0x00 and 0xFF",
         {"edges", "+frame_ok"}},
        // The receiver's four-byte buffer overflows while other interrupts run: fields shift.
        // p(shift) = q load
        {"fifo_overrun", 59, "bytes are lost when interrupts wait",
         {{"timing.overrun", 0.0, 1.0, 0.1, "blocked over 350 us", {0.05}}},
         "emerges from the emulated board", "the same traffic with the analogue service off", {"load", "+shifted|frame_ok"}},
        // Radio or line drop-outs, in bursts. p; after a broken frame p + (1 - p) b, of b < 0 p (1 + b)
        {"truncation", 60, "frames are cut now and then",
         {{"timing.truncation", 0.0, 1.0, 0.02, "1e-4..1e-2", {0.005}},
          {"timing.truncation_burst", -1.0, 1.0, 0.4, "bursts; below 0: none after another", {0.3, -0.3}}},
         "the overlay's [uart] answer_cut, answer_cut_again", "the same frames over a cable", {"+frame_ok"}},
        // Bytes and delays add to the nominal period. T = T0 + delta, with jitter
        {"long_period", 61, "the control loop takes longer than nominal",
         {{"timing.extra_period", -0.05, 0.2, 0.004, "104 ms typical", {0.004, -0.004}},
          {"timing.period_jitter", 0.0, 0.2, 0.003, "1..5 ms", {0.0005}}},
         "the overlay's [linux] oversleep, oversleep_jitter, beside what emerges from the emulated loop",
         "count periods against a second clock", {}, Scatter},
        // Crystals differ by tens of ppm, RC oscillators by percents. t_host = (1 + rho) t_robot
        {"clock_drift", 62, "the clocks of robot and host run apart",
         {{"timing.clock_drift", -0.2, 0.2, 0.003, "+-50 ppm; 1-2 % without crystal", {0.003, -0.003}}},
         "the overlay's [clock] pic_error", "a longer run", {"t_robot_s"}},
        // Radio and operating system deliver at their own ticks. t_host = ceil(t / B) B
        {"batching", 63, "the host hands frames over in batches",
         {{"timing.batch", 0.001, 1.0, 0.001, "ticks of 5..50 ms, USB polled every 1 ms; intervals bimodal", {0.02}, nullptr, 1e-6}},
         "the overlay's [linux] tty_batch", "log the robot's own clock", {}, Mean, false, {}, nullptr, false, true},
        // The program waits so long for an answer, and a batch comes later. whole if ceil(t / B) B - t < L
        {"late_answers", 67, "answers that a batch brings too late are given up",
         {{"timing.batch", 0.001, 1.0, 0.001, "as batching", {0.02}, nullptr, 1e-6},
          {"timing.answer_limit", 0.001, 1.0, 0.02, "10 to 100 ms in robots' programs", {0.015}}},
         "the overlay's [linux] tty_batch; giving up emerges from the program", "a program that waits longer",
         {"frame_ok"}, Mean, false, {}, nullptr, false, true},
    };
}
// clang-format on

}  // namespace puckloop::gap
