#include "tools/exec/wire.h"

namespace puckloop::exec {

namespace {

/// Line level at `offset` after the falling edge of the start bit.
bool level_at(const cosim::UartFrame& frame, cosim::Time offset) {
    const cosim::Time bit = offset / frame.bit_period;
    const int with_parity = frame.data_bits + (frame.parity != 0 ? 1 : 0);
    if (frame.is_break) return bit > with_parity + frame.stop_bits;
    if (bit == 0) return false;
    if (bit <= frame.data_bits) return ((frame.data >> (bit - 1)) & 1) != 0;
    if (bit <= with_parity) return frame.parity_bit != 0;
    return true;
}

}  // namespace

Sampled sample(const cosim::UartFrame& frame, cosim::Time bit_period) {
    constexpr int kDataBits = 8;
    const auto middle = [&](int bit) { return level_at(frame, bit * bit_period + bit_period / 2); };
    Sampled out;
    for (int i = 0; i < kDataBits; ++i)
        out.byte = static_cast<std::uint8_t>(out.byte | (middle(1 + i) ? 1u << i : 0u));
    out.clean = !middle(0) && middle(1 + kDataBits);
    return out;
}

cosim::UartFrame frame_of(std::uint8_t byte, cosim::Time start, cosim::Time bit_period) {
    cosim::UartFrame frame;
    frame.start = start;
    frame.bit_period = bit_period;
    frame.data = byte;
    return frame;
}

cosim::Time stop_bit(const cosim::UartFrame& frame) {
    return frame.start + (1 + frame.data_bits + (frame.parity != 0 ? 1 : 0)) * frame.bit_period;
}

}  // namespace puckloop::exec
