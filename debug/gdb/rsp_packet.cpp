#include "debug/gdb/rsp_packet.h"

#include <fmt/format.h>

#include <utility>

namespace puckloop::debug {

namespace {

constexpr char kEscape = '}', kFlip = 0x20, kCtrlC = 0x03;

int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

}  // namespace

std::string rsp_packet(std::string_view data) {
    std::string packet = "$";
    std::uint8_t sum = 0;
    const auto put = [&](char c) {
        packet += c;
        sum = static_cast<std::uint8_t>(sum + static_cast<std::uint8_t>(c));
    };
    for (const char c : data) {
        if (c == '$' || c == '#' || c == kEscape || c == '*') {
            put(kEscape);
            put(static_cast<char>(c ^ kFlip));
        } else {
            put(c);
        }
    }
    return packet + fmt::format("#{:02x}", sum);
}

void RspReader::feed(std::span<const char> bytes) {
    for (const char byte : bytes)
        take(byte);
}

std::optional<RspEvent> RspReader::next() {
    if (taken_ == events_.size()) {
        events_.clear();
        taken_ = 0;
        return std::nullopt;
    }
    return std::move(events_[taken_++]);
}

void RspReader::take(char byte) {
    switch (state_) {
    case State::Between:
        if (byte == '$') {
            state_ = State::Data;
            data_.clear();
            sum_ = 0;
            damaged_ = false;
        }
        if (byte == '-') events_.push_back({RspEvent::Kind::Again});
        if (byte == kCtrlC) events_.push_back({RspEvent::Kind::Interrupt});
        return;
    case State::Data:
    case State::Escaped:
        if (byte == '#') {
            damaged_ |= state_ == State::Escaped;
            state_ = State::High;
            return;
        }
        if (byte == '$') {  // the one before was cut off
            state_ = State::Between;
            return take(byte);
        }
        sum_ = static_cast<std::uint8_t>(sum_ + static_cast<std::uint8_t>(byte));
        if (state_ == State::Data && byte == kEscape) {
            state_ = State::Escaped;
            return;
        }
        if (data_.size() < kLongest)
            data_ += state_ == State::Escaped ? static_cast<char>(byte ^ kFlip) : byte;
        else
            damaged_ = true;
        state_ = State::Data;
        return;
    case State::High:
        damaged_ |= digit(byte) < 0;
        high_ = static_cast<std::uint8_t>(digit(byte) & 0xF);
        state_ = State::Low;
        return;
    case State::Low:
        damaged_ |= digit(byte) < 0 || (high_ << 4 | digit(byte)) != sum_;
        state_ = State::Between;
        if (damaged_)
            events_.push_back({RspEvent::Kind::Damaged});
        else
            events_.push_back({RspEvent::Kind::Packet, std::exchange(data_, {})});
        return;
    }
}

std::optional<std::uint64_t> take_hex(std::string_view& text) {
    constexpr std::size_t kMost = 16;
    std::uint64_t value = 0;
    std::size_t digits = 0;
    for (; digits < text.size() && digit(text[digits]) >= 0; ++digits)
        value = value << 4 | static_cast<std::uint64_t>(digit(text[digits]));
    if (digits == 0 || digits > kMost) return std::nullopt;
    text.remove_prefix(digits);
    return value;
}

bool take_char(std::string_view& text, char c) {
    if (text.empty() || text.front() != c) return false;
    text.remove_prefix(1);
    return true;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes)
        text += fmt::format("{:02x}", byte);
    return text;
}

std::string to_hex(std::string_view text) {
    std::string hex;
    for (const char c : text)
        hex += fmt::format("{:02x}", static_cast<std::uint8_t>(c));
    return hex;
}

std::optional<std::vector<std::uint8_t>> from_hex(std::string_view text) {
    if (text.size() % 2 != 0) return std::nullopt;
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < text.size(); i += 2) {
        const int high = digit(text[i]), low = digit(text[i + 1]);
        if (high < 0 || low < 0) return std::nullopt;
        bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
    }
    return bytes;
}

}  // namespace puckloop::debug
