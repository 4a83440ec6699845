#include "emu/xbee/serial_out.h"

#include <algorithm>
#include <array>

namespace puckloop::xbee {

using cosim::Time;

Time bit_period_of(std::uint32_t bd) {
    constexpr std::array<std::uint32_t, 8> kRates{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
    constexpr std::uint32_t kSamplesPerSecond = 1'000'000;  // 16 MHz / 16
    const std::uint32_t baud = bd < kRates.size() ? kRates[bd] : std::max<std::uint32_t>(bd, kRates[0]);
    const std::uint32_t divisor = std::max<std::uint32_t>(1, (kSamplesPerSecond + baud / 2) / baud);
    return divisor * cosim::kMicrosecond;
}

bool SerialOut::put(std::span<const std::uint8_t> bytes, Time now) {
    if (waiting_.size() + bytes.size() > kRoom) return false;
    if (waiting_.empty()) {
        free_ = std::max(free_, now);
        bit_ = wanted_bit_;
    }
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    return true;
}

void SerialOut::hold(bool held, Time now) {
    if (held_ && !held) free_ = std::max(free_, now);
    held_ = held;
}

void SerialOut::set_bit_period(Time period) {
    wanted_bit_ = period;
    if (waiting_.empty()) bit_ = period;
}

void SerialOut::clear() {
    waiting_.clear();
    held_ = false;
}

Time SerialOut::next() const {
    return waiting_.empty() || held_ ? cosim::kNever : free_;
}

cosim::UartFrame SerialOut::take() {
    cosim::UartFrame frame;
    frame.start = free_;
    frame.bit_period = bit_;
    frame.data = waiting_.front();
    waiting_.pop_front();
    free_ += kBits * bit_;
    ++sent_;
    if (waiting_.empty()) bit_ = wanted_bit_;
    return frame;
}

}  // namespace puckloop::xbee
