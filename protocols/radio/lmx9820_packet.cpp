#include "protocols/radio/lmx9820_packet.h"

#include <algorithm>

namespace puckloop::protocols {

namespace {

constexpr std::size_t kHeader = 6;  // with the start octet and the check

bool known_type(std::uint8_t type) {
    return type == kLmxRequest || type == kLmxConfirm || type == kLmxIndication || type == kLmxResponse;
}

std::uint8_t check_of(std::span<const std::uint8_t> octets) {
    unsigned sum = 0;
    for (std::size_t i = 1; i + 1 < kHeader; ++i)
        sum += octets[i];
    return static_cast<std::uint8_t>(sum);
}

std::size_t length_of(std::span<const std::uint8_t> octets) {
    return octets[3] | static_cast<std::size_t>(octets[4]) << 8;
}

}  // namespace

LmxBytes encode_lmx(const LmxPacket& packet) {
    const std::size_t size = std::min(packet.data.size(), kMostLmxData);
    LmxBytes octets;
    octets.reserve(kLmxFrame + size);
    for (const std::size_t octet : {std::size_t{kLmxStart}, std::size_t{packet.type},
                                    std::size_t{packet.opcode}, size & 0xff, size >> 8, std::size_t{0}})
        octets.push_back(static_cast<std::uint8_t>(octet));
    octets[kHeader - 1] = check_of(octets);
    for (std::size_t i = 0; i < size; ++i)
        octets.push_back(packet.data[i]);
    octets.push_back(kLmxEnd);
    return octets;
}

std::string_view to_text(LmxFault fault) {
    switch (fault) {
    case LmxFault::None:
        break;
    case LmxFault::Check:
        return "bad check";
    case LmxFault::Type:
        return "no packet type";
    case LmxFault::Length:
        return "too long";
    case LmxFault::End:
        return "no end octet";
    }
    return "";
}

LmxReading LmxReader::give(LmxFault fault, std::uint8_t octet) {
    LmxReading reading;
    reading.fault = fault;
    reading.packet.type = octets_[1];
    reading.packet.opcode = octets_[2];
    if (octets_.size() > kHeader) reading.packet.data.assign(octets_.begin() + kHeader, octets_.end() - 1);
    octets_.clear();
    if (fault != LmxFault::None && octet == kLmxStart) octets_.push_back(octet);
    return reading;
}

std::optional<LmxReading> LmxReader::take(std::uint8_t octet) {
    if (octets_.empty() && octet != kLmxStart) return std::nullopt;
    octets_.push_back(octet);
    if (octets_.size() < kHeader) return std::nullopt;
    if (octets_.size() == kHeader) {
        if (check_of(octets_) != octets_.back()) return give(LmxFault::Check, octet);
        if (!known_type(octets_[1])) return give(LmxFault::Type, octet);
        if (length_of(octets_) > kMostLmxData) return give(LmxFault::Length, octet);
        return std::nullopt;
    }
    if (octets_.size() < kLmxFrame + length_of(octets_)) return std::nullopt;
    return give(octet == kLmxEnd ? LmxFault::None : LmxFault::End, octet);
}

std::string lmx_address_text(std::span<const std::uint8_t> address) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string text;
    for (std::size_t i = address.size(); i-- > 0;) {
        text += kDigits[address[i] >> 4];
        text += kDigits[address[i] & 15];
        if (i > 0) text += ':';
    }
    return text;
}

}  // namespace puckloop::protocols
