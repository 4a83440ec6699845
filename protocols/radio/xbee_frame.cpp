#include "protocols/radio/xbee_frame.h"

#include <fmt/format.h>

#include <utility>

namespace puckloop::protocols {

namespace {

constexpr std::uint8_t kXon = 0x11, kXoff = 0x13;
constexpr std::uint8_t kEscapeXor = 0x20;

constexpr bool needs_escape(std::uint8_t byte) {
    return byte == kXBeeStart || byte == kXBeeEscape || byte == kXon || byte == kXoff;
}

}  // namespace

std::vector<std::uint8_t> encode_xbee(std::span<const std::uint8_t> data, XBeeApiMode mode) {
    std::vector<std::uint8_t> bytes{kXBeeStart};
    const auto put = [&](std::uint8_t byte) {
        if (mode == XBeeApiMode::Escaped && needs_escape(byte)) {
            bytes.push_back(kXBeeEscape);
            byte ^= kEscapeXor;
        }
        bytes.push_back(byte);
    };
    put(static_cast<std::uint8_t>(data.size() >> 8));
    put(static_cast<std::uint8_t>(data.size()));
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : data) {
        put(byte);
        sum = static_cast<std::uint8_t>(sum + byte);
    }
    put(static_cast<std::uint8_t>(0xFF - sum));
    return bytes;
}

std::string_view name_of(XBeeFault fault) {
    switch (fault) {
    case XBeeFault::None:
        return "none";
    case XBeeFault::Noise:
        return "noise";
    case XBeeFault::Restart:
        return "restart";
    case XBeeFault::Length:
        return "length";
    case XBeeFault::Check:
        return "check";
    case XBeeFault::Short:
        return "short";
    }
    return "?";
}

std::string explain(const XBeeReading& reading) {
    switch (reading.fault) {
    case XBeeFault::None:
        return "ok";
    case XBeeFault::Noise:
        return fmt::format("noise: no start delimiter 7E up to byte {}", reading.at);
    case XBeeFault::Restart:
        return fmt::format("restart: a start delimiter 7E as byte {}, inside a frame", reading.at);
    case XBeeFault::Length:
        return fmt::format("length: {} bytes of data, up to byte {}", reading.length, reading.at);
    case XBeeFault::Check: {
        std::uint8_t sum = 0;
        for (const std::uint8_t byte : reading.data)
            sum = static_cast<std::uint8_t>(sum + byte);
        return fmt::format("check: {:02X} up to byte {}, and the data needs {:02X}", reading.check,
                           reading.at, 0xFF - sum);
    }
    case XBeeFault::Short:
        return fmt::format("short: the bytes end at byte {}, inside the frame", reading.at);
    }
    return "?";
}

void XBeeReader::start() {
    now_ = {};
    sum_ = 0;
    escaped_ = noise_ = false;
    state_ = State::LengthHigh;
}

XBeeReading XBeeReader::give(XBeeFault fault) {
    XBeeReading reading = std::exchange(now_, {});
    reading.fault = fault;
    reading.at = taken_ - 1;
    state_ = State::Idle;
    escaped_ = noise_ = false;
    return reading;
}

std::optional<XBeeReading> XBeeReader::take(std::uint8_t byte) {
    ++taken_;
    if (byte == kXBeeStart && (state_ == State::Idle || mode_ == XBeeApiMode::Escaped)) {
        std::optional<XBeeReading> before;
        if (state_ != State::Idle)
            before = give(XBeeFault::Restart);
        else if (noise_)
            before = give(XBeeFault::Noise);
        start();
        return before;
    }
    if (state_ == State::Idle) {
        noise_ = true;
        return std::nullopt;
    }
    if (mode_ == XBeeApiMode::Escaped && !escaped_ && byte == kXBeeEscape) {
        escaped_ = true;
        return std::nullopt;
    }
    if (std::exchange(escaped_, false)) byte ^= kEscapeXor;
    switch (state_) {
    case State::Idle:
        break;
    case State::LengthHigh:
        now_.length = static_cast<std::uint16_t>(byte << 8);
        state_ = State::LengthLow;
        break;
    case State::LengthLow:
        now_.length = static_cast<std::uint16_t>(now_.length | byte);
        if (now_.length == 0 || now_.length > most_) return give(XBeeFault::Length);
        state_ = State::Data;
        break;
    case State::Data:
        now_.data.push_back(byte);
        sum_ = static_cast<std::uint8_t>(sum_ + byte);
        if (now_.data.size() == now_.length) state_ = State::Check;
        break;
    case State::Check:
        now_.check = byte;
        sum_ = static_cast<std::uint8_t>(sum_ + byte);
        return give(sum_ == 0xFF ? XBeeFault::None : XBeeFault::Check);
    }
    return std::nullopt;
}

std::optional<XBeeReading> XBeeReader::end() {
    if (state_ != State::Idle) return give(XBeeFault::Short);
    if (noise_) return give(XBeeFault::Noise);
    return std::nullopt;
}

}  // namespace puckloop::protocols
