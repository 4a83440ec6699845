// The line between a main board and its Bluetooth module.

#include "traces/decoders/decoders.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::tools {

using cosim::TraceRow;
using cosim::UartFrame;

namespace {

/// Bytes with more silence between them do not belong together.
constexpr cosim::Time kSilence = 3 * cosim::kMillisecond;

}  // namespace

void LmxDecoder::add(const TraceRow& row, const UartFrame& frame) {
    link_ = row.link;
    Side& side = sides_[row.from];
    const auto characters = receive(side.line, row, frame);
    if (characters.empty()) side.plain.add(row, frame, characters);
    for (const protocols::ReceivedCharacter& character : characters)
        take(row.from, side, row, frame, character);
}

void LmxDecoder::take(const std::string& from, Side& side, const TraceRow& row, const UartFrame& frame,
                      const protocols::ReceivedCharacter& character) {
    if (!side.plain.empty() && character.start - side.plain.end > kSilence) give_plain(from, side.plain);
    if (character.is_break || character.framing_error) {
        // A packet that it cuts is none.
        side.reader.clear();
        if (!side.packet.empty()) give_plain(from, side.packet);
        side.plain.add(row, frame, {character});
        return;
    }
    const auto reading = side.reader.take(static_cast<std::uint8_t>(character.data));
    if (!reading && side.reader.idle()) {
        side.plain.add(row, frame, {character});
        return;
    }
    if (!side.plain.empty()) give_plain(from, side.plain);
    side.packet.add(row, frame, {character});
    if (!reading) return;
    if (reading->ok()) return give_packet(from, side, reading->packet);
    side.packet.errors.push_back(std::string(protocols::to_text(reading->fault)));
    give_plain(from, side.packet);
    // The octet that ended it may begin the next.
    if (!side.reader.idle()) side.packet.add(row, frame, {character});
}

void LmxDecoder::give_packet(const std::string& from, Side& side, const protocols::LmxPacket& packet) {
    ByteRun run = std::exchange(side.packet, {});
    DecodedFrame frame{run.begin, run.end, link_, from, "bluetooth", protocols::to_text(packet), run.errors};
    frame.fields["message"] = protocols::lmx_opcode_name(packet.opcode);
    frame.fields["type"] = fmt::format("{:02x}", packet.type);
    frame.fields["opcode"] = fmt::format("{:02x}", packet.opcode);
    frame.fields["data"] = hex_bytes(packet.data);
    take_(frame);
}

void LmxDecoder::give_plain(const std::string& from, ByteRun& run) {
    const ByteRun done = std::exchange(run, {});
    DecodedFrame frame{done.begin, done.end, link_, from, "bytes", hex_bytes(done.bytes), done.errors};
    frame.fields["bytes"] = frame.text;
    const bool text = std::all_of(done.bytes.begin(), done.bytes.end(), [](std::uint8_t byte) {
        return (byte >= ' ' && byte <= '~' && byte != '"') || byte == '\r' || byte == '\n';
    });
    if (text && !done.bytes.empty()) {
        std::string shown;
        for (const std::uint8_t byte : done.bytes) {
            if (byte == '\r')
                shown += "\\r";
            else if (byte == '\n')
                shown += "\\n";
            else
                shown += static_cast<char>(byte);
        }
        frame.fields["text"] = shown;
        frame.text += fmt::format(" \"{}\"", shown);
    }
    take_(frame);
}

void LmxDecoder::end() {
    for (auto& [from, side] : sides_) {
        if (!side.packet.empty()) give_plain(from, side.packet);
        if (!side.plain.empty()) give_plain(from, side.plain);
    }
}

}  // namespace puckloop::tools
