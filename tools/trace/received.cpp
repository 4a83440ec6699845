#include "tools/trace/received.h"

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

std::vector<ReceivedCharacter> LineReceiver::take(const cosim::TraceRow& row, const cosim::UartFrame& frame) {
    if (keeps_from_arriving(row.fault)) return {};
    const bool sound = row.fault == cosim::FaultKind::None && frame.is_break == 0;
    if (sound) receiver_ = {frame.bit_period, frame.data_bits, frame.parity};
    std::vector<ReceivedCharacter> characters;
    if (sound || !receiver_ || receiver_->bit_period <= 0 || frame.bit_period <= 0 ||
        frame.bit_period / kSlowest > receiver_->bit_period)
        characters.push_back(as_sent(frame));
    else
        characters = protocols::sample_frame(frame, *receiver_, ready_);
    if (!characters.empty()) ready_ = characters.back().time;
    return characters;
}

std::string line_error(const ReceivedCharacter& character) {
    if (character.is_break) return "break";
    if (character.framing_error) return "framing error";
    return character.parity_error ? "wrong parity" : "";
}

}  // namespace puckloop::tools
