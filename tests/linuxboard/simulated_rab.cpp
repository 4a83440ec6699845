#include "tests/linuxboard/simulated_rab.h"

namespace puckloop::control {

namespace {

constexpr double kByteTime = 90e-6;   // s at 100 kHz
constexpr double kSendTime = 808e-6;  // s the board holds the bus to build a frame
constexpr std::size_t kQueue = 10;

}  // namespace

void SimulatedRab::receive(const SimulatedMessage& message) {
    if (queue_.size() < kQueue) queue_.push_back(message);
}

int SimulatedRab::transfer(std::span<const I2cMessage> messages) {
    clock_.time += kByteTime;
    if (refuse > 0) {
        --refuse;
        return error;
    }
    ++transfers;
    for (const I2cMessage& message : messages) {
        clock_.time += kByteTime * static_cast<double>(message.bytes.size() + 1);
        if (message.read) {
            for (std::uint8_t& byte : message.bytes) {
                const unsigned number = pointer_ + index_;
                byte = read_register(number);
                if (!first_ || !counts_like_the_board) ++index_;
                first_ = false;
            }
            continue;
        }
        pointer_ = message.bytes[0];
        index_ = 0;
        first_ = true;
        for (std::size_t i = 1; i < message.bytes.size(); ++i)
            write_register(pointer_, message.bytes[i]);
    }
    return 0;
}

std::uint8_t SimulatedRab::read_register(unsigned number) {
    const auto bearing = static_cast<std::uint16_t>(current_.bearing);
    switch (number) {
    case 0:
        polls.push_back(clock_.time);
        if (queue_.empty()) return 0;
        current_ = queue_.front();
        queue_.pop_front();
        return 1;
    case 1:
        return static_cast<std::uint8_t>(current_.data >> 8);
    case 2:
        return static_cast<std::uint8_t>(current_.data);
    case 3:
        return static_cast<std::uint8_t>(bearing >> 8);
    case 4:
        return static_cast<std::uint8_t>(bearing);
    case 5:
        return static_cast<std::uint8_t>(current_.strength >> 8);
    case 6:
        return static_cast<std::uint8_t>(current_.strength);
    case 10:
        return static_cast<std::uint8_t>(current_.data >> 24);
    case 11:
        return static_cast<std::uint8_t>(current_.data >> 16);
    default:
        return 0;
    }
}

void SimulatedRab::send(const Payloads& payloads) {
    clock_.time += kSendTime;
    Frame frame{payloads, clock_.time};
    for (auto& payload : frame.payloads)
        if (payload && bits < 32) *payload &= (1U << bits) - 1;
    frames.push_back(frame);
}

void SimulatedRab::write_register(std::uint8_t number, std::uint8_t value) {
    writes.emplace_back(number, value);
    const std::uint32_t payload = aux_ << 8 | value;
    Payloads all;
    switch (number) {
    case 12:
        range = value;
        break;
    case 13:
        aux_ = value;
        break;
    case 14:
        all.fill(payload);
        send(all);
        break;
    case 15:
        send(armed_);
        armed_ = {};
        break;
    case 19:
    case 20:
        aux_ = payload;
        break;
    case 21:
        if (value == 8 || value == 16 || value == 24 || value == 32) bits = value;
        break;
    default:
        if (number < armed_.size()) armed_[number] = payload;
    }
}

}  // namespace puckloop::control
