// The serial line, the robot's clock and its host's.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> timing_effects() {
    return {
        // Slaves stretch the clock or the bus is shared. + s per transfer
        {
            .name = "i2c_stretch",
            .number = 57,
            .title = "the I2C bus holds the cycle up",
            .parameters = {{"timing.i2c_stretch", -0.001, 0.05, 0.0015, "1..5 ms", {0.0015}}},
            .needs = {"i2c_reads"},
            .enters = "the overlay's [linux] i2c_hold, beside what emerges from the emulated bus",
            .separated_by = "the same loop with and without the I2C boards",
        },
        // An oscillator is off: bytes with long runs are misread. p(frame wrong) grows with edges
        {
            .name = "baud_mismatch",
            .number = 58,
            .title = "the two ends disagree about the baud rate",
            .parameters =
                {{"timing.edge_errors", 0.0, 0.5, 0.01, "0 at 14.7456 MHz; 2.1 % at 16 MHz", {0.005}}},
            .needs = {"edges"},
            .enters = "the overlay's [uart] answer_edge_loss",
            .separated_by = "frames of 0x55 against frames of 0x00 and 0xFF",
        },
        // The receiver's four-byte buffer overflows while other interrupts run: fields shift.
        // p(shift) = q load
        {
            .name = "fifo_overrun",
            .number = 59,
            .title = "bytes are lost when interrupts wait",
            .parameters = {{"timing.overrun", 0.0, 1.0, 0.1, "blocked over 350 us", {0.05}}},
            .needs = {"load"},
            .enters = "emerges from the emulated board",
            .separated_by = "the same traffic with the analogue service off",
        },
        // Radio or line drop-outs, in bursts. p, in bursts
        {
            .name = "truncation",
            .number = 60,
            .title = "frames are cut now and then",
            .parameters = {{"timing.truncation", 0.0, 0.5, 0.02, "1e-4..1e-2", {0.005}},
                           {"timing.truncation_burst", 0.0, 0.98, 0.4, "bursts", {0.3}}},
            .enters = "the overlay's [uart] answer_cut, answer_cut_again",
            .separated_by = "the same frames over a cable",
        },
        // Bytes and delays add to the nominal period. T = T0 + delta, with jitter
        {
            .name = "long_period",
            .number = 61,
            .title = "the control loop takes longer than nominal",
            .parameters = {{"timing.extra_period", -0.05, 0.2, 0.004, "104 ms typical", {0.004, -0.004}},
                           {"timing.period_jitter", 0.0, 0.2, 0.003, "1..5 ms", {0.0005}}},
            .enters = "the overlay's [linux] oversleep, oversleep_jitter, beside what emerges from the "
                      "emulated loop",
            .separated_by = "count periods against a second clock",
            .role = EffectRole::Scatter,
        },
        // Crystals differ by tens of ppm, RC oscillators by percents. t_host = (1 + rho) t_robot
        {
            .name = "clock_drift",
            .number = 62,
            .title = "the clocks of robot and host run apart",
            .parameters = {{"timing.clock_drift",
                            -0.2,
                            0.2,
                            0.003,
                            "+-50 ppm; 1-2 % without crystal",
                            {0.003, -0.003}}},
            .needs = {"t_robot_s"},
            .enters = "the overlay's [clock] pic_error",
            .separated_by = "a longer run",
        },
        // Radio and operating system deliver at their own ticks. t_host = ceil(t / B) B
        {
            .name = "batching",
            .number = 63,
            .title = "the host hands frames over in batches",
            .parameters = {{"timing.batch",
                            0.002,
                            1.0,
                            0.001,
                            "ticks of 5..50 ms; intervals bimodal",
                            {0.02},
                            nullptr,
                            1e-6}},
            .enters = "the overlay's [linux] tty_batch",
            .separated_by = "log the robot's own clock",
        },
    };
}

}  // namespace puckloop::gap
