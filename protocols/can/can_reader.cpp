#include "protocols/can/can_reader.h"

#include <algorithm>
#include <array>

namespace puckloop::protocols {

namespace {

constexpr int kIde = 13;  // bits counted without stuff bits, the start of frame as 0
constexpr int kShortestHead = 19;
constexpr int kCrcDelimiter = 1, kAcknowledgeSlot = 2, kAcknowledgeDelimiter = 3;  // counted in the tail

}  // namespace

std::string_view can_error_name(CanError error) {
    constexpr std::array<std::string_view, 6> kNames{"", "bit", "stuff", "form", "ack", "crc"};
    return kNames.at(static_cast<std::size_t>(error));
}

std::uint32_t CanReader::field(int first, int count) const {
    std::uint32_t value = 0;
    for (int bit = first; bit < first + count; ++bit)
        value = value << 1 | static_cast<std::uint32_t>(state_.bits[static_cast<std::size_t>(bit)]);
    return value;
}

int CanReader::bytes() const {
    const bool remote = state_.bits[extended() ? 32 : 12];
    return remote ? 0 : static_cast<int>(std::min(field(head() - 4, 4), 8u));
}

int CanReader::plain_bits() const {
    const int plain = state_.plain;
    if (plain <= kIde) return kShortestHead + kCrcBits;
    if (plain < head()) return head() + kCrcBits;
    return head() + 8 * bytes() + kCrcBits;
}

CanError CanReader::take(bool level) {
    State& state = state_;
    ++state.taken;
    if (state.tail == 0) {
        const bool stuffed = state.alike == kMostAlike;
        if (stuffed && level == state.last) return CanError::Stuff;
        state.alike = level == state.last ? static_cast<std::uint8_t>(state.alike + 1) : std::uint8_t{1};
        state.last = level;
        if (!stuffed && state.plain < plain_bits()) {
            state.bits[state.plain] = level;
            if (state.plain < plain_bits() - kCrcBits) state.crc = next_can_crc(state.crc, level);
            ++state.plain;
            return CanError::None;
        }
        if (stuffed) return CanError::None;
    }
    ++state.tail;
    if (state.tail == kCrcDelimiter) state.bad = field(state.plain - kCrcBits, kCrcBits) != state.crc;
    if (state.tail == kAcknowledgeSlot) return CanError::None;
    if (state.tail == kAcknowledgeDelimiter && state.bad) return CanError::Crc;
    return level == kDominant ? CanError::Form : CanError::None;
}

int CanReader::left() const {
    return plain_bits() - state_.plain + kCanTail - state_.tail;
}

CanFrame CanReader::frame() const {
    CanFrame frame;
    frame.extended = extended();
    frame.remote = state_.bits[frame.extended ? 32 : 12];
    frame.id = frame.extended ? field(1, 11) << 18 | field(14, 18) : field(1, 11);
    frame.length = static_cast<std::uint8_t>(std::min(field(head() - 4, 4), 8u));
    for (int i = 0; i < bytes(); ++i)
        frame.data[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(field(head() + 8 * i, 8));
    return frame;
}

}  // namespace puckloop::protocols
