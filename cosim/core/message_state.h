#pragma once
// What messages carry, as part of a saved state (base/states/archive.h).

#include "base/states/archive.h"
#include "cosim/core/message.h"

namespace puckloop::cosim {

/// An empty frame (bit_period 0) is a legal state; who samples frames checks for it.
template <class Archive>
void state(Archive& archive, UartFrame& frame) {
    archive(frame.start);
    archive.bounded(frame.bit_period, 0, kSecond);
    archive(frame.data);
    archive.bounded(frame.data_bits, 5, 9);
    archive.bounded(frame.parity, 0, 2);
    archive.bounded(frame.stop_bits, 1, 2);
    archive.bounded(frame.parity_bit, 0, 1);
    std::uint8_t flags = uart_flags(frame);
    archive.bounded(flags, 0, kMostUartFlags);
    if constexpr (Archive::kLoads) set_uart_flags(frame, flags);
    if ((flags & kFlagGlitch) == 0) return;
    archive(frame.glitch_at, frame.glitch_width);
    archive.check(frame.glitch_width != 0, "a glitch without a width");
}

template <class Archive>
void state(Archive& archive, I2cPhase& phase) {
    archive.bounded(phase.kind, I2cPhaseKind::Start, I2cPhaseKind::BusLost);
    archive(phase.byte);
    archive.bounded(phase.ack, 0, 1);
    archive(phase.start);
    archive.bounded(phase.clock_period, 0, kSecond);
    archive.bounded(phase.stretch, 0, kNever);
}

template <class Archive>
void state(Archive& archive, Signal& signal) {
    archive(signal.id, signal.value);
}

template <class Archive>
void state(Archive& archive, RadioFrame& frame) {
    archive(frame.start);
    archive.bounded(frame.duration, 0, kSecond);
    archive(frame.channel, frame.dbm);
    const auto view = frame.octets.view();
    std::vector<std::uint8_t> octets(view.begin(), view.end());
    archive(octets);
    archive.check(octets.size() <= kMostRadioOctets, "a radio frame is too long");
    if constexpr (Archive::kLoads) frame.octets = Octets(octets);
}

template <class Archive>
void state(Archive& archive, CanMessage& can) {
    archive(can.start, can.data, can.id, can.bit_time, can.transmit_errors, can.receive_errors);
    archive.bounded(can.kind, CanKind::Join, CanKind::Wake);
    archive.bounded(can.length, 0, 8);
    archive(can.flags, can.tag, can.position);
    archive.check(can.flags >> kCanErrorShift <= kMostCanError, "a CAN error that is none");
}

template <class Archive>
void state(Archive& archive, Packet& packet) {
    archive(packet.start);
    archive.bounded(packet.duration, 0, kSecond);
    const auto view = packet.octets.view();
    std::vector<std::uint8_t> octets(view.begin(), view.end());
    archive(octets);
    archive.check(octets.size() <= kMostPacketOctets, "a packet is too long");
    if constexpr (Archive::kLoads) packet.octets = Octets(octets);
}

template <class Archive>
void state(Archive& archive, Message& message) {
    archive.bounded(message.time, 0, kNever);
    archive(message.port);
    auto kind = static_cast<std::uint8_t>(message.payload.index());
    archive.bounded(kind, 0, 5);
    if constexpr (Archive::kLoads) {
        if (kind == 0) message.payload = UartFrame{};
        if (kind == 1) message.payload = I2cPhase{};
        if (kind == 2) message.payload = Signal{};
        if (kind == 3) message.payload = RadioFrame{};
        if (kind == 4) message.payload = CanMessage{};
        if (kind == 5) message.payload = Packet{};
    }
    std::visit([&](auto& payload) { archive(payload); }, message.payload);
}

}  // namespace puckloop::cosim
