#include "traces/can_frames.h"

#include "cosim/can/can_message.h"
#include "cosim/trace/can_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::tools {

using cosim::CanMessage, cosim::CanKind, cosim::Time;
using protocols::CanError;

namespace {

constexpr int kFlagBits = 6;
constexpr unsigned kErrorStep = 8, kMostActive = 127;

CanMessage message_of(const protocols::CanFrame& frame) {
    CanMessage message;
    message.kind = CanKind::Sent;
    cosim::put_frame(message, frame);
    return message;
}

}  // namespace

std::optional<CanOnBus> can_on_bus(const cosim::TraceRow& row) {
    const auto* message = std::get_if<CanMessage>(&row.payload);
    if (message == nullptr || !cosim::has_frame(*message)) return std::nullopt;
    if (message->kind != CanKind::Sent && message->kind != CanKind::Error) return std::nullopt;
    CanOnBus seen;
    seen.bus = row.from;
    seen.sender = row.link.starts_with(row.from + ".") ? row.link.substr(row.from.size() + 1) : row.link;
    seen.frame = cosim::frame_in(*message);
    seen.start = message->start;
    seen.bit = message->bit_time;
    seen.error = message->kind == CanKind::Error ? cosim::error_in(*message) : CanError::None;
    seen.position = message->position;
    seen.transmit_errors = message->transmit_errors;
    seen.receive_errors = message->receive_errors;
    return seen;
}

std::vector<std::pair<Time, Time>> CanOnBus::dominant() const {
    const protocols::CanBits bits = can_levels(frame);
    std::vector<bool> levels;
    const bool failed = error != CanError::None;
    const int count = failed ? std::min(position + 1, bits.count) : bits.count;
    for (int i = 0; i < count; ++i)
        levels.push_back(!failed && i == bits.acknowledge() ? protocols::kDominant : bits[i]);
    // A sender that was error passive before sends a recessive flag.
    const unsigned before = transmit_errors > kErrorStep ? transmit_errors - kErrorStep : 0;
    if (failed && before <= kMostActive && receive_errors <= kMostActive)
        levels.insert(levels.end(), kFlagBits, protocols::kDominant);
    std::vector<std::pair<Time, Time>> stretches;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (levels[i] == protocols::kRecessive) continue;
        const Time begin = start + static_cast<Time>(i) * bit;
        if (!stretches.empty() && stretches.back().second == begin)
            stretches.back().second += bit;
        else
            stretches.emplace_back(begin, begin + bit);
    }
    return stretches;
}

Time CanOnBus::end() const {
    constexpr int kErrorFrame = 6 + 8;
    const int bits = error == CanError::None ? can_bits(frame) : position + 1 + kErrorFrame;
    return start + bits * bit;
}

std::string CanOnBus::text() const {
    return cosim::can_data_text(message_of(frame));
}

std::string CanOnBus::error_text() const {
    if (error == CanError::None) return {};
    const std::string_view what =
        error == CanError::Acknowledge ? "nobody acknowledges" : can_error_name(error);
    return fmt::format("{}{} at bit {}, tec {} rec {}", what, error == CanError::Acknowledge ? "" : " error",
                       position, transmit_errors, receive_errors);
}

std::vector<std::uint8_t> CanOnBus::socketcan() const {
    // linux/can.h and linux/can/error.h.
    constexpr std::uint32_t kExtended = 0x8000'0000, kRemote = 0x4000'0000, kErrorFrame = 0x2000'0000;
    constexpr std::uint32_t kProtocol = 0x08, kNoAcknowledge = 0x20, kCounters = 0x200;
    constexpr std::uint8_t kBit = 0x01, kForm = 0x02, kStuff = 0x04, kCrcSequence = 0x08;
    std::uint32_t id = frame.id | (frame.extended ? kExtended : 0) | (frame.remote ? kRemote : 0);
    std::array<std::uint8_t, 8> data = frame.data;
    std::uint8_t length = frame.length;
    if (error != CanError::None) {
        id = kErrorFrame | kCounters | (error == CanError::Acknowledge ? kNoAcknowledge : kProtocol);
        data = {};
        if (error == CanError::Bit) data[2] = kBit;
        if (error == CanError::Form) data[2] = kForm;
        if (error == CanError::Stuff) data[2] = kStuff;
        if (error == CanError::Crc) data[3] = kCrcSequence;
        constexpr unsigned kMost = 255;
        data[6] = static_cast<std::uint8_t>(std::min(transmit_errors, kMost));
        data[7] = static_cast<std::uint8_t>(std::min(receive_errors, kMost));
        length = static_cast<std::uint8_t>(data.size());
    }
    std::vector<std::uint8_t> packet;
    for (int shift = 24; shift >= 0; shift -= 8)
        packet.push_back(static_cast<std::uint8_t>(id >> shift));
    packet.insert(packet.end(), {length, 0, 0, 0});
    const bool remote = error == CanError::None && frame.remote;
    packet.insert(packet.end(), data.begin(), data.begin() + (remote ? 0 : length));
    return packet;
}

}  // namespace puckloop::tools
