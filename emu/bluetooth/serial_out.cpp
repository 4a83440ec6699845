#include "emu/bluetooth/serial_out.h"

#include "protocols/serial/uart_sampling.h"

#include <algorithm>
#include <array>
#include <bit>

namespace puckloop::bluetooth {

using cosim::Time;

std::uint32_t baud_of(std::uint8_t speed) {
    constexpr std::array<std::uint32_t, 11> kRates{2400,  4800,   7200,   9600,   19200, 38400,
                                                   57600, 115200, 230400, 460800, 921600};
    return speed < kRates.size() ? kRates[speed] : 0;
}

Time SerialOut::bit_period_of(const SerialSettings& settings) {
    const Time baud = baud_of(settings.speed);
    return (cosim::kSecond + baud / 2) / baud;
}

void SerialOut::add(const Character& character, Time now) {
    if (waiting_.empty()) free_ = std::max(free_, now);
    waiting_.push_back(character);
}

void SerialOut::put(std::span<const std::uint8_t> bytes, Time now) {
    for (const std::uint8_t byte : bytes)
        add({byte, false, settings_}, now);
}

void SerialOut::put_break(Time now) {
    add({0, true, settings_}, now);
}

cosim::UartFrame SerialOut::take() {
    const Character character = waiting_.front();
    waiting_.pop_front();
    cosim::UartFrame frame;
    frame.start = free_;
    frame.bit_period = bit_period_of(character.settings);
    frame.data = character.data;
    frame.stop_bits = character.settings.stop_bits;
    frame.parity = character.settings.parity;
    if (frame.parity != 0)
        frame.parity_bit =
            static_cast<std::uint8_t>((std::popcount(frame.data) & 1) ^ (frame.parity == 1 ? 1 : 0));
    frame.is_break = character.is_break ? 1 : 0;
    if (character.is_break) frame.parity_bit = 0;
    free_ = protocols::frame_end(frame);
    // The line is high for a character behind a break, so that the next start bit is one.
    if (character.is_break) free_ += 10 * frame.bit_period;
    ++sent_;
    return frame;
}

}  // namespace puckloop::bluetooth
