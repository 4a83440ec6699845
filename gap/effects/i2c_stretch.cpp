#include "gap/effects/list.h"

namespace puckloop::gap {

Effect i2c_stretch() {
    return {
        .name = "i2c_stretch",
        .number = 57,
        .title = "the I2C bus holds the cycle up",
        .mechanism = "Slaves stretch the clock or the bus is shared.",
        .equation = "+ s per transfer",
        .kinds = {Kind::Timing},
        .parameters = {{"timing.i2c_stretch", -0.001, 0.05, 0.0015, {0.0015}, "1..5 ms"}},
        .needs = {"i2c_reads"},
        .observables = "arrival by number of transfers",
        .enters = "the overlay's [linux] i2c_hold, beside what emerges from the emulated bus",
        .confounded = {"batching"},
        .separated_by = "the same loop with and without the I2C boards",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
