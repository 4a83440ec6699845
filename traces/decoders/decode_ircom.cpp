#include "traces/decoders/decoders.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

// Flashes of the proximity sensors are no words.
constexpr int kFewestEdges = 20;

}  // namespace

bool IrcomDecoder::add(const cosim::TraceRow& row, const cosim::Signal& signal) {
    const bool is_board = row.from.ends_with(".pic") && row.signal.starts_with(kPulse);
    const bool is_tam = row.from.ends_with(".avr") && row.signal == kBarrier;
    if (!row.link.ends_with(".ircom") || !(is_board || is_tam)) return false;
    for (auto& [name, sender] : senders_)
        if (row.time - sender.last >= protocols::IrcomReader::kRest)
            if (const auto reading = sender.reader.until(row.time)) give(name.first, name.second, *reading);
    Sender& sender = senders_[{row.link, row.from}];
    const auto any = [&] {
        return std::any_of(sender.lit.begin(), sender.lit.end(), [](const auto& one) { return one.second; });
    };
    const bool before = any();
    sender.lit[row.signal] = signal.value != 0.0;
    if (any() == before) return true;
    sender.last = row.time;
    if (const auto reading = sender.reader.edge(row.time, !before)) give(row.link, row.from, *reading);
    return true;
}

void IrcomDecoder::give(const std::string& link, const std::string& from,
                        const protocols::IrcomReading& reading) {
    if (!reading.ok() && reading.edges < kFewestEdges) return;
    DecodedFrame frame{reading.start, reading.end, link, from, "ircom", {}, {}};
    const bool readable = reading.ok() || reading.fault == protocols::IrcomFault::Check;
    if (readable) {
        frame.fields["word"] = reading.word;
        frame.fields["symbols"] = protocols::ircom_text(reading.symbols);
        frame.text = fmt::format("word {:02x} check {} {}", reading.word, reading.check,
                                 protocols::ircom_text(reading.symbols));
    } else {
        frame.text = fmt::format("{} edges", reading.edges);
    }
    if (!reading.ok()) frame.errors.push_back(explain(reading));
    take_(frame);
}

void IrcomDecoder::end() {
    for (auto& [name, sender] : senders_)
        if (const auto reading = sender.reader.until(sender.last + protocols::IrcomReader::kRest))
            give(name.first, name.second, *reading);
}

}  // namespace puckloop::tools
