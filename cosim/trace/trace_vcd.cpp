#include "cosim/trace/trace_vcd.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace puckloop::cosim {

namespace {

constexpr unsigned kByteWidth = 9;  // nine-bit frames fit
const std::string kUnknownByte = "bx ";

/// Short printable identifiers, as the format asks.
std::string identifier(std::size_t n) {
    constexpr std::size_t kFirst = 33, kCount = 94;
    std::string text;
    do {
        text += static_cast<char>(kFirst + n % kCount);
        n /= kCount;
    } while (n != 0);
    return text;
}

/// Names must not hold blanks.
std::string word(const std::string& name) {
    std::string text = name.empty() ? "_" : name;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c <= ' '; }, '_');
    return text;
}

std::string binary(unsigned value) {
    return fmt::format("b{:b} ", value);
}

}  // namespace

std::size_t VcdWriter::variable(const TraceRow& row, const std::string& name, const std::string& type,
                                unsigned width, const std::string& initial) {
    const auto [found, is_new] =
        index_.try_emplace(fmt::format("{}\n{}\n{}", row.link, row.from, name), variables_.size());
    if (is_new) variables_.push_back({row.link, row.from, name, type, width, initial});
    return found->second;
}

void VcdWriter::change(Time time, std::size_t variable, std::string value) {
    changes_.push_back({std::max<Time>(time, 0), variable, std::move(value)});
}

void VcdWriter::add_frame(const TraceRow& row, const UartFrame& frame) {
    const std::size_t line = variable(row, "line", "wire", 1, "1");
    const std::size_t byte = variable(row, "byte", "wire", kByteWidth, kUnknownByte);
    Time now = frame.start;
    bool level = true;
    const auto drive = [&](bool next, unsigned bits) {
        if (next != level) change(now, line, next ? "1" : "0");
        level = next;
        now += frame.bit_period * bits;
    };
    change(frame.start, byte, frame.is_break ? binary(0) : binary(frame.data));
    drive(false, 1);
    for (unsigned bit = 0; bit < frame.data_bits; ++bit)
        drive(!frame.is_break && (frame.data >> bit & 1) != 0, 1);
    if (frame.parity != 0) drive(!frame.is_break && frame.parity_bit != 0, 1);
    drive(frame.is_break == 0, frame.stop_bits);
    drive(true, 0);
    change(now, byte, kUnknownByte);
}

void VcdWriter::add(const TraceRow& row) {
    if (keeps_from_arriving(row.fault)) return;
    if (const auto* frame = std::get_if<UartFrame>(&row.payload)) {
        add_frame(row, *frame);
    } else if (const auto* phase = std::get_if<I2cPhase>(&row.payload)) {
        static constexpr std::string_view kNames[] = {"start", "write", "read", "stop",
                                                      "ack",   "data",  "lost"};
        std::string_view name = kNames[static_cast<std::size_t>(phase->kind)];
        if (phase->kind == I2cPhaseKind::Acknowledge && phase->ack == 0) name = "nack";
        change(row.time, variable(row, "phase", "string", 1, "s "), fmt::format("s{} ", name));
        change(row.time, variable(row, "byte", "wire", kByteWidth, kUnknownByte), binary(phase->byte));
    } else if (const auto* radio = std::get_if<RadioFrame>(&row.payload)) {
        const std::size_t on_air = variable(row, "on_air", "wire", 1, "0");
        change(radio->start, on_air, "1");
        change(radio->start + radio->duration, on_air, "0");
        change(row.time, variable(row, "octets", "string", 1, "s "),
               fmt::format("s{} ", hex_of(radio->octets)));
    } else {
        const auto& signal = std::get<Signal>(row.payload);
        const std::string name = row.signal.empty() ? fmt::format("signal{}", signal.id) : row.signal;
        change(row.time, variable(row, name, "real", 64, "r0 "), fmt::format("r{} ", signal.value));
    }
}

void VcdWriter::write_declarations(std::ostream& out) const {
    out << "$version puckloop $end\n$timescale 1 ps $end\n";
    // The map's order puts the variables of a link and sender side by side.
    std::string link, from;
    bool open = false;
    for (const auto& [key, n] : index_) {
        const Variable& variable = variables_[n];
        if (!open || variable.link != link || variable.from != from) {
            if (open) out << "$upscope $end\n$upscope $end\n";
            link = variable.link;
            from = variable.from;
            open = true;
            out << "$scope module " << word(link) << " $end\n$scope module " << word(from) << " $end\n";
        }
        out << "$var " << variable.type << ' ' << variable.width << ' ' << identifier(n) << ' '
            << word(variable.name) << " $end\n";
    }
    if (open) out << "$upscope $end\n$upscope $end\n";
    out << "$enddefinitions $end\n$dumpvars\n";
    for (std::size_t n = 0; n < variables_.size(); ++n)
        out << variables_[n].initial << identifier(n) << '\n';
    out << "$end\n";
}

void VcdWriter::write(std::ostream& out) {
    write_declarations(out);
    // Stable: changes of one instant keep the order in which they came, so that a frame's end does not hide
    // the byte of the next one.
    std::stable_sort(changes_.begin(), changes_.end(),
                     [](const Change& a, const Change& b) { return a.time < b.time; });
    Time now = -1;
    for (const Change& change : changes_) {
        if (change.time != now) out << '#' << change.time << '\n';
        now = change.time;
        out << change.value << identifier(change.variable) << '\n';
    }
}

}  // namespace puckloop::cosim
