#include "cosim/core/codec.h"

#include <fmt/format.h>

#include <bit>

namespace puckloop::cosim {

namespace {
enum class PayloadTag : std::uint8_t { Uart, I2c, Signal, Radio, Can, Packet };
constexpr std::uint8_t kFirstChannel = 11, kLastChannel = 26;
}  // namespace

void ByteWriter::f64(double value) {
    u64(std::bit_cast<std::uint64_t>(value));
}

void ByteWriter::text(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
}

void ByteWriter::payload(const Payload& payload) {
    if (const auto* frame = std::get_if<UartFrame>(&payload)) {
        u8(static_cast<std::uint8_t>(PayloadTag::Uart));
        time(frame->start);
        time(frame->bit_period);
        u16(frame->data);
        u8(frame->data_bits);
        u8(frame->parity);
        u8(frame->stop_bits);
        u8(frame->parity_bit);
        u8(uart_flags(*frame));
        if (frame->glitch_width != 0) {
            u32(frame->glitch_at);
            u32(frame->glitch_width);
        }
    } else if (const auto* phase = std::get_if<I2cPhase>(&payload)) {
        u8(static_cast<std::uint8_t>(PayloadTag::I2c));
        u8(static_cast<std::uint8_t>(phase->kind));
        u8(phase->byte);
        u8(phase->ack);
        time(phase->start);
        time(phase->clock_period);
        time(phase->stretch);
    } else if (const auto* signal = std::get_if<Signal>(&payload)) {
        u8(static_cast<std::uint8_t>(PayloadTag::Signal));
        u16(signal->id);
        f64(signal->value);
    } else if (const auto* radio = std::get_if<RadioFrame>(&payload)) {
        u8(static_cast<std::uint8_t>(PayloadTag::Radio));
        time(radio->start);
        time(radio->duration);
        u8(radio->channel);
        u8(static_cast<std::uint8_t>(radio->dbm));
        const auto octets = radio->octets.view();
        u8(static_cast<std::uint8_t>(octets.size()));
        bytes_.insert(bytes_.end(), octets.begin(), octets.end());
    } else if (const auto* packet = std::get_if<Packet>(&payload)) {
        u8(static_cast<std::uint8_t>(PayloadTag::Packet));
        time(packet->start);
        time(packet->duration);
        const auto octets = packet->octets.view();
        u16(static_cast<std::uint16_t>(octets.size()));
        bytes_.insert(bytes_.end(), octets.begin(), octets.end());
    } else {
        const auto& can = std::get<CanMessage>(payload);
        u8(static_cast<std::uint8_t>(PayloadTag::Can));
        u8(static_cast<std::uint8_t>(can.kind));
        time(can.start);
        bytes_.insert(bytes_.end(), can.data.begin(), can.data.end());
        u32(can.id);
        u32(can.bit_time);
        u16(can.transmit_errors);
        u8(can.receive_errors);
        u8(can.length);
        u8(can.flags);
        u8(can.tag);
        u8(can.position);
    }
}

void ByteWriter::message(const Message& message) {
    time(message.time);
    u16(message.port);
    payload(message.payload);
}

void ByteReader::fail(const char* what) const {
    throw CodecError(fmt::format("{} at byte {} of {}", what, position_, bytes_.size()));
}

std::uint64_t ByteReader::little_endian(std::size_t count) {
    if (left() < count) fail("ends too early");
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
        value |= static_cast<std::uint64_t>(bytes_[position_ + i]) << (8 * i);
    position_ += count;
    return value;
}

double ByteReader::f64() {
    return std::bit_cast<double>(u64());
}

bool ByteReader::boolean() {
    const std::uint8_t value = u8();
    if (value > 1) fail("value out of range");
    return value == 1;
}

std::string ByteReader::text() {
    const std::size_t size = u32();
    if (size > left()) fail("text longer than the message");
    const auto from = bytes_.begin() + static_cast<std::ptrdiff_t>(position_);
    std::string value(from, from + static_cast<std::ptrdiff_t>(size));
    position_ += size;
    return value;
}

Payload ByteReader::payload() {
    switch (enumerator(PayloadTag::Packet)) {
    case PayloadTag::Uart: {
        UartFrame frame;
        frame.start = time();
        frame.bit_period = time();
        frame.data = u16();
        frame.data_bits = u8();
        frame.parity = u8();
        frame.stop_bits = u8();
        frame.parity_bit = u8();
        const std::uint8_t flags = u8();
        set_uart_flags(frame, flags);
        if (flags & kFlagGlitch) {
            frame.glitch_at = u32();
            frame.glitch_width = u32();
        }
        if (frame.data_bits < 5 || frame.data_bits > 9 || frame.parity > 2 || frame.stop_bits < 1 ||
            frame.stop_bits > 2 || frame.parity_bit > 1 || flags > kMostUartFlags ||
            uart_flags(frame) != flags || frame.bit_period <= 0)
            fail("UART frame with values out of range");
        return frame;
    }
    case PayloadTag::I2c: {
        I2cPhase phase;
        phase.kind = enumerator(I2cPhaseKind::BusLost);
        phase.byte = u8();
        phase.ack = u8();
        if (phase.ack > kMostI2cAck) fail("I2C phase with an acknowledge out of range");
        phase.start = time();
        phase.clock_period = time();
        phase.stretch = time();
        return phase;
    }
    case PayloadTag::Radio: {
        RadioFrame radio;
        radio.start = time();
        radio.duration = time();
        radio.channel = u8();
        radio.dbm = static_cast<std::int8_t>(u8());
        const std::size_t size = u8();
        if (radio.duration < 0 || radio.channel < kFirstChannel || radio.channel > kLastChannel ||
            size == 0 || size > kMostRadioOctets || size > left())
            fail("radio frame with values out of range");
        radio.octets = Octets(bytes_.subspan(position_, size));
        position_ += size;
        return radio;
    }
    case PayloadTag::Can: {
        CanMessage can;
        can.kind = enumerator(CanKind::Wake);
        can.start = time();
        for (std::uint8_t& byte : can.data)
            byte = u8();
        can.id = u32();
        can.bit_time = u32();
        can.transmit_errors = u16();
        can.receive_errors = u8();
        can.length = u8();
        can.flags = u8();
        can.tag = u8();
        can.position = u8();
        if (can.length > can.data.size() || can.flags >> kCanErrorShift > kMostCanError || can.id >= 1u << 29)
            fail("CAN message with values out of range");
        return can;
    }
    case PayloadTag::Packet: {
        Packet packet;
        packet.start = time();
        packet.duration = time();
        const std::size_t size = u16();
        if (packet.duration < 0 || size < kFewestPacketOctets || size > kMostPacketOctets || size > left())
            fail("packet with values out of range");
        packet.octets = Octets(bytes_.subspan(position_, size));
        position_ += size;
        return packet;
    }
    case PayloadTag::Signal:
        break;
    }
    Signal signal;
    signal.id = u16();
    signal.value = f64();
    return signal;
}

Message ByteReader::message() {
    Message message;
    message.time = time();
    message.port = u16();
    message.payload = payload();
    return message;
}

std::size_t ByteReader::count(std::size_t smallest) {
    const std::size_t items = u32();
    if (items > left() / smallest) fail("more items than the message can hold");
    return items;
}

void ByteReader::end() const {
    if (left() != 0) fail("more bytes than expected");
}

}  // namespace puckloop::cosim
