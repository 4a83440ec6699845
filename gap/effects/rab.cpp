// Range and bearing.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> rab_effects() {
    return {
        // Parts and soldering. s_ij = g_i g_j s
        {
            .name = "strength_spread_parts",
            .number = 46,
            .title = "emitters and receivers differ in gain",
            .parameters = {{"rab.receiver_gain*", 0.2, 4.0, 0.25, "log-normal 0.1..0.3"},
                           {"rab.emitter_gain*", 0.2, 4.0, 0.25, "as receivers"}},
            .enters = "ir.receiver_gain, ir.emitter_gain",
            .separated_by = "turn the receiver before one fixed emitter, with several pairs of boards",
        },
        // Diodes and detectors of another make, or set deeper in the ring. light cos(a)^n, strength cos(b)^m
        {
            .name = "rab_lobe",
            .number = 46,
            .title = "emitters or receivers are more or less directed",
            .parameters =
                {{"rab.emitter_lobe", 0.1, 12.0, 0.5, "1: a wide diode; 12: 20 degrees to the half", {2.0}},
                 {"rab.receiver_lobe", 0.1, 6.0, 0.25, "0.5: what the board's formula assumes", {1.0}}},
            .enters = "ir.emitter_exponent, ir.receiver_exponent",
            .separated_by = "one emitter at a time, the sender turned",
        },
        // Contact, alignment and reflections vary from message to message. sd of ln s (1 + m)
        {
            .name = "range_noise",
            .number = 47,
            .title = "strengths scatter more than the simulator's",
            .parameters =
                {{"rab.strength_spread", -0.9, 5.0, 0.5, "0.36 at contact, 0.11-0.15 beyond", {0.2}}},
            .enters = "ir.frame_noise, ir.receiver_noise, ir.near_noise",
            .separated_by = "several pairs of boards at one distance, turned",
            .role = EffectRole::Scatter,
        },
        // Background and automatic gain keep far readings above a floor. s = max(s, floor)
        {
            .name = "far_floor",
            .number = 48,
            .title = "far strengths stay up",
            .parameters =
                {{"rab.far_floor", 100.0, 3000.0, 400.0, "median 920 beyond 45 cm", {950.0, 1150.0}}},
            .enters = "ir.level",
            .separated_by = "distances beyond half a metre",
        },
        // The peak detector reaches its rail. s = min(s, S)
        {
            .name = "strength_saturation",
            .number = 49,
            .title = "near strengths are clipped early",
            .parameters = {{"rab.saturation", 300.0, 4095.0, 1500.0, "4095; readings fold below 2 cm"}},
            .enters = "ir.rail",
            .separated_by = "distances below 5 cm",
        },
        // Another path wins: longer, weaker, from elsewhere. with probability w: ln s - l, bearing scattered
        {
            .name = "multipath",
            .number = 51,
            .title = "messages come by reflections",
            .parameters = {{"rab.multipath", 0.0, 0.7, 0.08, "w .05..0.2", {0.05}},
                           {"rab.multipath_loss", 0.1, 2.5, 0.5, "-3..-10 dB"}},
            .enters = "ir.stray, ir.stray_loss, beside the scenario's walls and bodies",
            .separated_by = "the same in the middle of an empty room",
            .role = EffectRole::Outlier,
        },
        // Boards that do not listen before sending overlap. p_ok = exp(-2 (N - 1) T_frame / T_period)
        {
            .name = "collision_loss",
            .number = 52,
            .title = "frames of several senders collide",
            .parameters =
                {{"rab.collisions", 0.0, 2.0, 0.5, "1 for senders that know nothing of each other", {0.3}}},
            .needs = {"senders"},
            .enters = "emerges from boards that send",
            .separated_by = "the same place with one, two and four senders",
        },
        // Weak light, interference, interrupts. p_ok = 1 - q
        {
            .name = "random_loss",
            .number = 53,
            .title = "messages are lost whoever sends",
            .parameters = {{"rab.random_loss", 0.0, 0.95, 0.15, "30 % to 85 % reported", {0.05}}},
            .enters = "ir.loss, beside the losses that emerge",
            .separated_by = "one sender only, many messages in a row",
        },
        // The board's queue overflows. p_ok = min(1, capacity / rate)
        {
            .name = "poll_loss",
            .number = 54,
            .title = "the host polls too slowly",
            .parameters = {{"rab.fetch_time", 0.0, 0.5, 0.02, "50 messages a second at 20 ms", {0.02, 0.04}}},
            .needs = {"arrival_rate|senders"},
            .enters = "emerges from the poll period of the Linux program",
            .separated_by = "the same senders with a faster and a slower poll",
        },
        // Two crystals beat: while the edges meet, frames are lost. lost while the phase lies in a window
        {
            .name = "beat_loss",
            .number = 55,
            .title = "losses come in spells",
            .parameters = {{"rab.beat", 0.0, 0.7, 0.1, "1-5 % of frames", {0.05}},
                           {"rab.beat_burst", 0.01, 20.0, 1.0, "beat 10-60 s", {0.3}}},
            .needs = {"t_s"},
            .enters = "ir.spell, ir.spell_time, beside what emerges from the crystals",
            .separated_by = "long records at two temperatures",
        },
        // The receiver or the truth's axis is turned. bearing + b
        {
            .name = "bearing_offset",
            .number = 15,
            .title = "bearings are off by a constant",
            .parameters = {{"rab.bearing_offset", -1.5, 1.5, 0.1, "-2..+8 degrees"}},
            .enters = "ir.receiver_angle",
            .separated_by = "the sender moved round the receiver",
        },
        // Emitter power, window or supply. ln s + g
        {
            .name = "rab_strength_scale",
            .number = 26,
            .title = "all strengths are higher or lower",
            .parameters = {{"rab.strength_gain", -2.0, 2.0, 0.25,
                            "641 against 1050 counts at 20 cm between robots"}},
            .enters = "ir.receiver_gain, all twelve",
            .separated_by = "a second pair of boards",
        },
    };
}

}  // namespace puckloop::gap
