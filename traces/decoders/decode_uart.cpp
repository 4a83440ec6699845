// Characters, runs of bytes, and XBee API frames.

#include "protocols/radio/xbee_message.h"
#include "protocols/serial/uart_sampling.h"
#include "traces/decoders/decoders.h"

#include <fmt/format.h>

namespace puckloop::tools {

using cosim::TraceRow;
using cosim::UartFrame;
using nlohmann::ordered_json;

std::string hex_bytes(const std::vector<std::uint8_t>& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes)
        text += fmt::format("{}{:02x}", text.empty() ? "" : " ", byte);
    return text;
}

void ByteRun::add(const TraceRow& row, const UartFrame& frame,
                  const std::vector<protocols::ReceivedCharacter>& characters) {
    if (empty()) begin = frame.start;
    end = protocols::frame_end(frame);
    const auto note = [&](unsigned data, std::string what) {
        if (row.fault != cosim::FaultKind::None)
            what += fmt::format("{}fault {}{}", what.empty() ? "" : ", ", fault_name(row.fault),
                                keeps_from_arriving(row.fault) ? ": lost"
                                : characters.empty()           ? ": no character"
                                                               : "");
        if (!what.empty())
            errors.push_back(fmt::format("byte {} ({:02x} at {} s): {}", bytes.size() + 1, data,
                                         cosim::format_seconds(frame.start), what));
    };
    if (characters.empty()) note(frame.data, "");
    for (const protocols::ReceivedCharacter& character : characters) {
        note(character.data, line_error(character));
        bytes.push_back(static_cast<std::uint8_t>(character.data));
    }
}

void BytesDecoder::add(const TraceRow& row, const UartFrame& frame) {
    constexpr std::size_t kMost = 64;  // bytes on one line of text
    link_ = row.link;
    ByteRun& run = runs_[row.from];
    if (run.bytes.size() >= kMost || frame.start > run.end + 2 * frame.bit_period) hand_over(row.from);
    run.add(row, frame, receive(receivers_[row.from], row, frame));
}

namespace {

/// What a terminal would show; empty where that is not all of it.
std::string printable(const std::vector<std::uint8_t>& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) {
        if (byte == '\r' || byte == '\n')
            text += byte == '\r' ? "\\r" : "\\n";
        else if (byte >= ' ' && byte <= '~')
            text += static_cast<char>(byte);
        else
            return {};
    }
    return text;
}

}  // namespace

void BytesDecoder::hand_over(const std::string& from) {
    ByteRun& run = runs_[from];
    if (run.empty()) return;
    DecodedFrame frame{run.begin, run.end, link_, from, "bytes", hex_bytes(run.bytes), run.errors};
    frame.fields["bytes"] = frame.text;
    if (const std::string text = printable(run.bytes); !text.empty()) {
        frame.fields["text"] = text;
        frame.text += fmt::format(" \"{}\"", text);
    }
    run = {};
    take_(frame);
}

void BytesDecoder::end() {
    for (const auto& [from, run] : runs_)
        hand_over(from);
}

namespace {

std::string text_of(const protocols::XBeeCommand& command) {
    for (const char c : command)
        if (c <= ' ' || c > '~')
            return fmt::format("{:02x}{:02x}", static_cast<unsigned char>(command[0]),
                               static_cast<unsigned char>(command[1]));
    return {command.begin(), command.end()};
}
std::string text_of(const protocols::XBeeBytes& bytes) {
    return bytes.empty() ? "-" : hex_bytes(bytes);
}
std::string text_of(std::unsigned_integral auto number) {
    return fmt::format("{:0{}x}", number, 2 * sizeof number);
}

}  // namespace

void XBeeDecoder::give(const std::string& from, Side& side, const protocols::XBeeReading& reading) {
    ByteRun& run = side.run;
    DecodedFrame frame{run.begin, run.end, link_, from, "xbee", {}, run.errors};
    if (reading.ok()) {
        std::visit(
            [&]<typename Message>(const Message& message) {
                frame.text = Message::kName;
                frame.fields["message"] = Message::kName;
                Message::fields(message, [&](std::string_view name, const auto& member) {
                    const std::string text = text_of(member);
                    frame.text += fmt::format(" {} {}", name, text);
                    frame.fields[std::string(name)] = text == "-" ? "" : text;
                });
            },
            protocols::decode_xbee(reading.data));
    } else {
        frame.text = fmt::format("[{}]", hex_bytes(run.bytes));
        frame.fields["bytes"] = hex_bytes(run.bytes);
        frame.errors.push_back(explain(reading));
    }
    run = {};
    take_(frame);
}

void XBeeDecoder::add(const TraceRow& row, const UartFrame& frame) {
    link_ = row.link;
    Side& side = sides_[row.from];
    const auto characters = receive(side.line, row, frame);
    if (characters.empty()) side.run.add(row, frame, characters);
    for (const protocols::ReceivedCharacter& character : characters)
        take(row.from, side, row, frame, character);
}

/// The first start delimiter ends noise, and a frame that another begins in: those give the reading of what
/// was before.
void XBeeDecoder::take(const std::string& from, Side& side, const TraceRow& row, const UartFrame& frame,
                       const protocols::ReceivedCharacter& character) {
    side.run.add(row, frame, {character});
    const auto reading = side.reader.take(static_cast<std::uint8_t>(character.data));
    if (!reading) return;
    const bool begins_next =
        (reading->fault == protocols::XBeeFault::Noise || reading->fault == protocols::XBeeFault::Restart) &&
        character.data == protocols::kXBeeStart;
    if (begins_next) side.run.bytes.pop_back();
    give(from, side, *reading);
    if (begins_next) {
        TraceRow sound = row;
        sound.fault = cosim::FaultKind::None;
        side.run.add(sound, frame, {character});
    }
}

void XBeeDecoder::end() {
    for (auto& [from, side] : sides_)
        if (const auto reading = side.reader.end()) give(from, side, *reading);
}

}  // namespace puckloop::tools
