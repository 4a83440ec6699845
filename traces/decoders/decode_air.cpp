// What is on the air: infra-red frames of range-and-bearing boards, frames of the 2.4 GHz mesh.

#include "protocols/infrared/rab_frame.h"
#include "protocols/radio/mesh_frame.h"
#include "traces/decoders/decoders.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::tools {

using cosim::Time;

namespace {

constexpr Time kChip = 98'085 * cosim::kNanosecond;  // protocols/infrared/rab_frame.h
constexpr Time kEndOfFrame = 4 * kChip;              // Manchester: never more than two chips alike
constexpr std::size_t kMostChips = 200;

}  // namespace

void RabDecoder::edge(Emitter& emitter, Time time, bool level) {
    if (level == emitter.level) return;
    if (emitter.chips.empty() && level) {
        emitter.begin = time;
    } else if (emitter.chips.size() < kMostChips) {
        const Time chips = std::min<Time>((time - emitter.edge + kChip / 2) / kChip, 8);
        emitter.chips.append(static_cast<std::size_t>(std::max<Time>(chips, 0)), emitter.level ? '1' : '0');
    }
    emitter.edge = time;
    emitter.level = level;
}

bool RabDecoder::add(const cosim::TraceRow& row, const cosim::Signal& signal) {
    if (!row.signal.starts_with(kEmitter) || !row.from.ends_with(".rab")) return false;
    int number = 0;
    const char* end = row.signal.data() + row.signal.size();
    if (std::from_chars(row.signal.data() + kEmitter.size(), end, number).ptr != end || number < 1 ||
        number > kEmitters)
        return false;
    Board& board = boards_[{row.link, row.from}];
    close(row.link, row.from, board, row.time);
    edge(board.emitters[static_cast<std::size_t>(number - 1)], row.time, signal.value != 0.0);
    return true;
}

/// Emitters that are silent for long enough have sent a frame; equal ones are one.
void RabDecoder::close(const std::string& link, const std::string& from, Board& board, Time now) {
    for (std::size_t first = 0; first < board.emitters.size(); ++first) {
        Emitter& emitter = board.emitters[first];
        if (emitter.chips.empty() || emitter.level || now - emitter.edge < kEndOfFrame) continue;
        const Emitter done = emitter;
        std::string who;
        int count = 0;
        for (std::size_t i = first; i < board.emitters.size(); ++i) {
            Emitter& other = board.emitters[i];
            if (other.begin != done.begin || other.chips != done.chips || other.level) continue;
            who += fmt::format("{}{}", who.empty() ? "" : ",", i + 1);
            ++count;
            other.chips.clear();
        }
        if (count == kEmitters) who = "all";
        // A last chip that is off is silence to whoever sees light only.
        std::string chips = done.chips;
        if (chips.size() % 2 != 0) chips += '0';
        const protocols::RabFrameReading reading = protocols::decode_rab(chips);
        DecodedFrame frame{
            done.begin, done.begin + static_cast<Time>(chips.size()) * kChip, link, from, "rab", {}, {}};
        frame.fields = {{"emitters", who}, {"bits", reading.size}, {"chips", chips}};
        frame.text = fmt::format("emitters {}", who);
        if (reading.ok()) {
            frame.fields["payload"] = reading.payload;
            frame.text +=
                fmt::format(" payload {:0{}x} check {:x}", reading.payload, reading.size / 4, reading.check);
        } else {
            frame.text += fmt::format(" chips {}", chips);
            frame.errors.push_back(explain(reading));
        }
        take_(frame);
    }
}

void RabDecoder::end() {
    for (auto& [name, board] : boards_) {
        Time last = 0;
        for (const Emitter& emitter : board.emitters)
            last = std::max(last, emitter.edge);
        close(name.first, name.second, board, last + kEndOfFrame);
    }
}

void decode_mark(const FaultMark& mark, const TakeFrame& take) {
    DecodedFrame frame{mark.time, mark.time, mark.place, mark.place, "fault", mark.text(), {}};
    frame.errors.push_back("fault " + mark.kind);
    frame.fields = {{"kind", mark.kind}, {"what", mark.what}};
    take(frame);
}

void decode_radio(const cosim::TraceRow& row, const cosim::RadioFrame& radio, const TakeFrame& take) {
    static constexpr std::string_view kKinds[] = {"data",        "acknowledge",     "route request",
                                                  "route reply", "discover",        "discovered",
                                                  "remote AT",   "remote AT answer"};
    DecodedFrame frame{radio.start, radio.start + radio.duration, row.link, row.from, "mesh", {}, {}};
    const auto reading = protocols::decode_mesh(radio.octets.view());
    frame.fields = {{"channel", radio.channel}, {"dbm", radio.dbm}, {"octets", hex_of(radio.octets)}};
    if (reading.fault == protocols::MeshFault::None) {
        const protocols::MeshFrame& it = reading.frame;
        const std::string_view kind =
            kKinds[std::min<std::size_t>(static_cast<std::size_t>(it.kind), std::size(kKinds) - 1)];
        frame.text =
            fmt::format("ch{} {} dBm {} {:016x} -> {:016x} hop {:016x} -> {:016x} sequence {}", radio.channel,
                        radio.dbm, kind, it.origin, it.target, it.hop_from, it.hop_to, it.sequence);
        if (!it.data.empty()) frame.text += fmt::format(" data {}", hex_bytes(it.data));
        frame.fields["kind"] = kind;
        frame.fields["origin"] = fmt::format("{:016x}", it.origin);
        frame.fields["target"] = fmt::format("{:016x}", it.target);
        frame.fields["sequence"] = it.sequence;
        frame.fields["data"] = hex_bytes(it.data);
    } else {
        frame.text = fmt::format("ch{} {} dBm {} octets [{}]", radio.channel, radio.dbm,
                                 radio.octets.view().size(), hex_of(radio.octets));
        // Acknowledgements and requests of the MAC layer are shorter than any frame of the mesh.
        if (reading.fault != protocols::MeshFault::Short)
            frame.errors.push_back(std::string(name_of(reading.fault)));
    }
    if (row.fault != cosim::FaultKind::None)
        frame.errors.push_back(
            fmt::format("fault {}{}", fault_name(row.fault), keeps_from_arriving(row.fault) ? ": lost" : ""));
    take(frame);
}

}  // namespace puckloop::tools
