#include "traces/received.h"

#include <bit>

namespace puckloop::tools {

using cosim::Time;
using protocols::ReceivedCharacter;

namespace {

// Slower frames are no characters any more: the line is low or high for them.
constexpr Time kSlowest = 64;

bool parity_is_wrong(const cosim::UartFrame& frame) {
    if (frame.parity == 0) return false;
    const bool odd = (std::popcount(frame.data) + frame.parity_bit) % 2 != 0;
    return odd != (frame.parity == 1);
}

ReceivedCharacter as_sent(const cosim::UartFrame& frame) {
    ReceivedCharacter character;
    character.start = frame.start;
    character.time = protocols::stop_bit_start(frame);
    character.is_break = frame.is_break != 0;
    character.framing_error = character.is_break;
    character.data = character.is_break ? std::uint16_t{0} : frame.data;
    character.parity_error = !character.is_break && parity_is_wrong(frame);
    return character;
}

}  // namespace

const cosim::Packet* sent_packet(const cosim::TraceRow& row) {
    return row.from.ends_with(".linux") ? std::get_if<cosim::Packet>(&row.payload) : nullptr;
}

const cosim::RadioFrame* radio_on_air(const cosim::TraceRow& row) {
    const auto* radio = std::get_if<cosim::RadioFrame>(&row.payload);
    return radio != nullptr && radio->duration > 0 ? radio : nullptr;
}

std::optional<protocols::UartReceiver> setting_of(const cosim::TraceRow& row, const cosim::UartFrame& frame) {
    if (row.fault != cosim::FaultKind::None || frame.is_break != 0 || frame.bit_period <= 0)
        return std::nullopt;
    return protocols::UartReceiver{frame.bit_period, frame.data_bits, frame.parity};
}

std::vector<ReceivedCharacter> LineReceiver::take(const cosim::TraceRow& row, const cosim::UartFrame& frame) {
    if (keeps_from_arriving(row.fault)) return {};
    const auto setting = setting_of(row, frame);
    if (setting) receiver_ = setting;
    if (!receiver_ && row.fault == cosim::FaultKind::FalseStart) return {};
    constexpr std::uint8_t kUsualBits = 8;
    const protocols::UartReceiver receiver =
        receiver_.value_or(protocols::UartReceiver{frame.bit_period, kUsualBits, frame.parity});
    std::vector<ReceivedCharacter> characters;
    if (setting || frame.bit_period <= 0 || frame.bit_period / kSlowest > receiver.bit_period)
        characters.push_back(as_sent(frame));
    else
        characters = protocols::sample_frame(frame, receiver, ready_);
    if (!characters.empty()) ready_ = characters.back().time;
    return characters;
}

std::string line_error(const ReceivedCharacter& character) {
    if (character.is_break) return "break";
    if (character.framing_error) return "framing error";
    return character.parity_error ? "wrong parity" : "";
}

}  // namespace puckloop::tools
