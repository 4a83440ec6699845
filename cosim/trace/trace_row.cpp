#include "cosim/trace/trace_row.h"

#include "base/error.h"
#include "cosim/trace/can_row.h"
#include "protocols/network/ip_packet.h"
#include "protocols/serial/irda.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

namespace puckloop::cosim {

namespace {

constexpr std::size_t kFields = 10;
constexpr std::string_view kParityLetters = "NOE";
// In the order of I2cPhaseKind; Read and Acknowledge give the ninth bit as well.
constexpr std::array<std::string_view, 7> kPhases{"start", "write", "read", "stop", "", "data", "lost"};

void put_quoted(std::string& out, std::string_view text) {
    if (text.find_first_of(",\"\n") == std::string_view::npos) {
        out += text;
        return;
    }
    out += '"';
    for (const char c : text) {
        if (c == '"') out += '"';
        out += c == '\n' ? ' ' : c;
    }
    out += '"';
}

void put_number(std::string& out, std::uint64_t number) {
    std::array<char, 20> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    out.append(digits.data(), end);
}

/// As the shortest decimal that reads back as the same number.
void put_value(std::string& out, double value) {
    constexpr double kWhole = 1e15;  // below, whole numbers have no exponent
    if (!std::signbit(value) && value < kWhole && value == std::trunc(value))
        put_number(out, static_cast<std::uint64_t>(value));
    else
        out += fmt::format("{}", value);
}

void put_seconds(std::string& out, Time time) {
    constexpr std::uint64_t kPerSecond = kSecond;
    constexpr std::size_t kDigits = 12;
    const std::uint64_t size =
        time < 0 ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
    if (time < 0) out += '-';
    put_number(out, size / kPerSecond);
    std::array<char, kDigits + 1> fraction;
    fraction[0] = '.';
    // In two halves that fit 32 bits.
    constexpr std::uint64_t kHalf = 1'000'000;
    auto high = static_cast<std::uint32_t>(size % kPerSecond / kHalf);
    auto low = static_cast<std::uint32_t>(size % kHalf);
    for (std::size_t i = kDigits / 2; i > 0; --i, high /= 10, low /= 10) {
        fraction[i] = static_cast<char>('0' + high % 10);
        fraction[i + kDigits / 2] = static_cast<char>('0' + low % 10);
    }
    out.append(fraction.data(), fraction.size());
}

/// At least two digits.
void put_hex(std::string& out, unsigned value) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    for (int shift = value > 0xfff ? 12 : value > 0xff ? 8 : 4; shift >= 0; shift -= 4)
        out += kDigits[(value >> shift) & 0xf];
}

// cosim/i2c/i2c_shared.h, which is above this folder.
constexpr std::uint8_t kBehindNinthClock = 2, kDeviceAcknowledges = 3;
constexpr std::string_view kBehindNinth = "write+ninth", kDeviceHolds = "data+device",
                           kLooseClocks = "clocks+";

void put_phase(std::string& out, const I2cPhase& phase) {
    if (phase.kind == I2cPhaseKind::Acknowledge) {
        out += phase.ack ? "ack" : "nack";
        return;
    }
    if (phase.kind == I2cPhaseKind::Write && phase.ack == kBehindNinthClock) {
        out += kBehindNinth;
        return;
    }
    if (phase.kind == I2cPhaseKind::Data && phase.ack == kDeviceAcknowledges) {
        out += kDeviceHolds;
        return;
    }
    if (phase.kind == I2cPhaseKind::Data && phase.ack > kDeviceAcknowledges) {  // LooseClocks
        out += kLooseClocks;
        put_hex(out, phase.ack);
        return;
    }
    out += kPhases.at(static_cast<std::size_t>(phase.kind));
    if (phase.kind == I2cPhaseKind::Read) out += phase.ack ? "+ack" : "+nack";
}

constexpr std::string_view kGlitch = " glitch ", kRestsLow = " low", kInverted = " inverted",
                           kPulses = " irda";

/// What a damaged line did to a frame, or one of another polarity or coding.
void put_line(std::string& out, const UartFrame& frame) {
    if (protocols::is_infrared(frame)) out += kPulses;
    if (frame.line & kLineInverted) out += kInverted;
    if (frame.line & kLineRestsLow) out += kRestsLow;
    if (frame.glitch_width != 0 && !protocols::is_infrared(frame))
        out += fmt::format("{}{}+{}ns", kGlitch, frame.glitch_at, frame.glitch_width);
}

void put_payload(std::string& out, const UartFrame& frame) {
    if (frame.is_break) {
        out += "break,,";
    } else {
        out += "uart,";
        put_hex(out, frame.data);
        out += ',';
    }
    put_number(out, frame.data_bits);
    out += kParityLetters[frame.parity % kParityLetters.size()];
    put_number(out, frame.stop_bits);
    if (frame.parity != 0) out += frame.parity_bit ? " p1" : " p0";
    if (!is_sound(frame)) put_line(out, frame);
    out += ',';
    put_seconds(out, frame.start);
    out += ',';
    put_seconds(out, frame.bit_period);
    out += ',';
}

void put_payload(std::string& out, const I2cPhase& phase) {
    out += "i2c,";
    put_hex(out, phase.byte);
    out += ',';
    put_phase(out, phase);
    for (const Time time : {phase.start, phase.clock_period, phase.stretch}) {
        out += ',';
        put_seconds(out, time);
    }
}

std::string to_radio_detail(const RadioFrame& frame) {
    return fmt::format("ch{} {}dBm", frame.channel, frame.dbm);
}

void put_payload(std::string& out, const RadioFrame& frame) {
    out += "radio,";
    out += hex_of(frame.octets);
    out += ',';
    out += to_radio_detail(frame);
    out += ',';
    put_seconds(out, frame.start);
    out += ',';
    put_seconds(out, frame.duration);
    out += ',';
}

void put_payload(std::string& out, const CanMessage& message) {
    out += "can,";
    out += can_data_text(message);
    out += ',';
    out += can_detail_text(message);
    out += ',';
    put_seconds(out, message.start);
    out += ',';
    put_seconds(out, message.bit_time);
    out += ',';
}

void put_payload(std::string& out, const Packet& packet) {
    out += "packet,";
    out += hex_of(packet.octets);
    out += ',';
    const auto read = protocols::decode_ip(packet.octets.view());
    out += read ? protocols::describe(*read) : "damaged";
    out += ',';
    put_seconds(out, packet.start);
    out += ',';
    put_seconds(out, packet.duration);
    out += ',';
}

/// Reads fields, and reports where and what when one cannot be.
class Parser {
  public:
    Parser(std::string_view text, std::string_view file, std::size_t line) : file_(file), line_(line) {
        fields_.emplace_back();
        bool in_quotes = false;
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '"' && in_quotes && i + 1 < text.size() && text[i + 1] == '"') {
                fields_.back() += text[++i];
            } else if (text[i] == '"') {
                in_quotes = !in_quotes;
            } else if (text[i] == ',' && !in_quotes) {
                fields_.emplace_back();
            } else {
                fields_.back() += text[i];
            }
        }
        if (fields_.size() != kFields)
            fail(fmt::format("{} fields", fields_.size()), fmt::format("{}: {}", kFields, kTraceColumns));
    }

    const std::string& operator[](std::size_t field) const { return fields_[field]; }

    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const {
        throw InputError(file_, fmt::format("line {}", line_), problem, expected);
    }

    Time time(std::size_t field) const {
        const std::string& text = fields_[field];
        const std::size_t dot = text.find('.');
        const bool negative = !text.empty() && text[0] == '-';
        long long whole = 0;
        unsigned long long fraction = 0;
        constexpr std::size_t kDigits = 12;
        constexpr long long kMostSeconds = 9'000'000;
        const char* begin = text.data() + (negative ? 1 : 0);
        const bool shaped = dot != std::string::npos && text.size() - dot - 1 == kDigits &&
                            std::from_chars(begin, text.data() + dot, whole).ptr == text.data() + dot &&
                            std::from_chars(text.data() + dot + 1, text.data() + text.size(), fraction).ptr ==
                                text.data() + text.size();
        if (!shaped || whole < 0 || whole > kMostSeconds)
            fail(fmt::format("\"{}\" is no time", text), "seconds with twelve decimals");
        const Time value = whole * kSecond + static_cast<Time>(fraction);
        return negative ? -value : value;
    }

    /// How long something lasts: whatever is added to a time stays one.
    Time span(std::size_t field) const {
        constexpr Time kLongest = 10'000 * kSecond;
        const Time value = time(field);
        if (value < 0 || value > kLongest)
            fail(fmt::format("\"{}\" is no duration", fields_[field]), "0 to 10000 s");
        return value;
    }

    unsigned hex(std::size_t field, unsigned most) const {
        const std::string& text = fields_[field];
        unsigned value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
        if (error != std::errc() || end != text.data() + text.size() || value > most)
            fail(fmt::format("\"{}\" is no data", text), "hex digits");
        return value;
    }

  private:
    std::string file_;
    std::size_t line_;
    std::vector<std::string> fields_;
};

/// Takes what a damaged line did off the end of a frame's format; leaves there what it does not understand.
void take_line(std::string& format, UartFrame& frame) {
    if (const std::size_t at = format.find(kGlitch); at != std::string::npos) {
        const char* const end = format.data() + format.size();
        const char* next = std::from_chars(format.data() + at + kGlitch.size(), end, frame.glitch_at).ptr;
        if (next == end || *next != '+') return;
        next = std::from_chars(next + 1, end, frame.glitch_width).ptr;
        if (std::string_view(next, end) != "ns" || frame.glitch_width == 0) return;
        format.resize(at);
    }
    const auto ends = [&](std::string_view word) {
        if (!format.ends_with(word)) return false;
        format.resize(format.size() - word.size());
        return true;
    };
    const auto take = [&](std::string_view word, std::uint8_t flag) {
        if (ends(word)) frame.line |= flag;
    };
    take(kRestsLow, kLineRestsLow);
    take(kInverted, kLineInverted);
    if (ends(kPulses)) protocols::set_infrared(frame);
}

UartFrame parse_frame(const Parser& in) {
    UartFrame frame;
    std::string format = in[5];
    take_line(format, frame);
    const std::size_t parity = format.size() < 3 ? std::string::npos : kParityLetters.find(format[1]);
    const bool has_parity_bit =
        format.size() == 6 && format.substr(3, 2) == " p" && (format[5] == '0' || format[5] == '1');
    if (parity == std::string::npos || format[0] < '5' || format[0] > '9' || format[2] < '1' ||
        format[2] > '2' || has_parity_bit != (parity != 0) || (format.size() != 3 && !has_parity_bit))
        in.fail(fmt::format("\"{}\" is no frame format", in[5]), "8N1, 9E2 p1, ...");
    frame.data_bits = static_cast<std::uint8_t>(format[0] - '0');
    frame.parity = static_cast<std::uint8_t>(parity);
    frame.stop_bits = static_cast<std::uint8_t>(format[2] - '0');
    frame.parity_bit = has_parity_bit && format[5] == '1';
    frame.start = in.time(6);
    frame.bit_period = in.span(7);
    frame.is_break = in[3] == "break";
    if (!frame.is_break) frame.data = static_cast<std::uint16_t>(in.hex(4, 0x1ff));
    return frame;
}

I2cPhase parse_phase(const Parser& in) {
    I2cPhase phase;
    phase.byte = static_cast<std::uint8_t>(in.hex(4, 0xff));
    phase.start = in.time(6);
    phase.clock_period = in.span(7);
    phase.stretch = in.span(8);
    const std::string& text = in[5];
    const auto* named = std::find(kPhases.begin(), kPhases.end(), text);
    if (text == "ack" || text == "nack") {
        phase.kind = I2cPhaseKind::Acknowledge;
        phase.ack = text == "ack";
    } else if (text == "read+ack" || text == "read+nack") {
        phase.kind = I2cPhaseKind::Read;
        phase.ack = text == "read+ack";
    } else if (text == kBehindNinth || text == kDeviceHolds) {
        phase.kind = text == kBehindNinth ? I2cPhaseKind::Write : I2cPhaseKind::Data;
        phase.ack = text == kBehindNinth ? kBehindNinthClock : kDeviceAcknowledges;
    } else if (text.starts_with(kLooseClocks)) {
        phase.kind = I2cPhaseKind::Data;
        unsigned ack = 0;
        const char* const end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data() + kLooseClocks.size(), end, ack, 16);
        if (error != std::errc() || rest != end || ack > kMostI2cAck)
            in.fail(fmt::format("\"{}\" is no I2C phase", text), "clocks+ and two hexadecimal digits");
        phase.ack = static_cast<std::uint8_t>(ack);
    } else if (named != kPhases.end() && !text.empty() && text != "read") {
        phase.kind = static_cast<I2cPhaseKind>(named - kPhases.begin());
    } else {
        in.fail(fmt::format("\"{}\" is no I2C phase", text), "start, write, read+ack, stop, ...");
    }
    return phase;
}

Signal parse_signal(const Parser& in, std::string& name) {
    Signal signal;
    char* end = nullptr;
    signal.value = std::strtod(in[4].c_str(), &end);
    if (in[4].empty() || *end != '\0') in.fail(fmt::format("\"{}\" is no value", in[4]), "a number");
    name = in[5];
    if (name.size() > 1 && name[0] == '#') {
        const auto [stop, error] = std::from_chars(name.data() + 1, name.data() + name.size(), signal.id);
        if (error != std::errc() || stop != name.data() + name.size())
            in.fail(fmt::format("\"{}\" is no signal", name), "a name or #id");
        name.clear();
    }
    return signal;
}

Octets parse_octets(const Parser& in, std::size_t fewest, std::size_t most, std::string_view what) {
    const std::string& text = in[4];
    std::vector<std::uint8_t> octets(text.size() / 2);
    bool good = text.size() % 2 == 0 && octets.size() >= fewest && octets.size() <= most;
    for (std::size_t i = 0; good && i < octets.size(); ++i) {
        const char* digits = text.data() + 2 * i;
        good = std::from_chars(digits, digits + 2, octets[i], 16).ptr == digits + 2;
    }
    if (!good)
        in.fail(fmt::format("\"{}\" is no {}", text, what),
                fmt::format("{} to {} octets, two hex digits each", fewest, most));
    return Octets(octets);
}

/// What the fifth column says of it follows from the octets.
Packet parse_packet(const Parser& in) {
    Packet packet;
    packet.octets = parse_octets(in, kFewestPacketOctets, kMostPacketOctets, "packet");
    packet.start = in.time(6);
    packet.duration = in.span(7);
    return packet;
}

RadioFrame parse_radio(const Parser& in) {
    RadioFrame frame;
    frame.octets = parse_octets(in, 1, kMostRadioOctets, "radio frame");
    const std::string& detail = in[5];
    const char* end = detail.data() + detail.size();
    bool shaped = detail.starts_with("ch");
    const char* at = detail.data() + 2;
    if (shaped) {
        at = std::from_chars(at, end, frame.channel).ptr;
        shaped = at != end && *at == ' ';
    }
    if (shaped) shaped = std::string_view(std::from_chars(at + 1, end, frame.dbm).ptr, end) == "dBm";
    if (!shaped || to_radio_detail(frame) != detail)
        in.fail(fmt::format("\"{}\" is no channel and power", detail), "ch12 -60dBm, ...");
    frame.start = in.time(6);
    frame.duration = in.span(7);
    return frame;
}

CanMessage parse_can_message(const Parser& in) {
    std::optional<CanMessage> message = parse_can(in[4], in[5]);
    if (!message)
        in.fail(fmt::format("\"{}\", \"{}\" is no CAN message", in[4], in[5]),
                "123#0102, sent tag 0 tec 0 rec 0, ...");
    constexpr Time kLongestBit = 0xFFFFFFFF;
    const Time bit = in.span(7);
    if (bit > kLongestBit) in.fail(fmt::format("\"{}\" is no bit time", in[7]), "up to 4.29 ms");
    message->start = in.time(6);
    message->bit_time = static_cast<std::uint32_t>(bit);
    return *message;
}

}  // namespace

std::string hex_of(const Octets& octets) {
    std::string text;
    for (const std::uint8_t octet : octets.view())
        put_hex(text, octet);
    return text;
}

std::string format_seconds(Time time) {
    std::string text;
    put_seconds(text, time);
    return text;
}

std::string sender_columns(std::string_view link, std::string_view from) {
    std::string text = ",";
    put_quoted(text, link);
    text += ',';
    put_quoted(text, from);
    return text + ",";
}

std::string signal_column(std::string_view name, std::uint16_t id) {
    if (name.empty()) return fmt::format("#{}", id);
    std::string text;
    put_quoted(text, name);
    return text;
}

void append_row(std::string& out, Time time, std::string_view sender, const Payload& payload,
                std::string_view signal, FaultKind fault) {
    put_seconds(out, time);
    out += sender;
    if (const auto* frame = std::get_if<UartFrame>(&payload)) {
        put_payload(out, *frame);
    } else if (const auto* phase = std::get_if<I2cPhase>(&payload)) {
        put_payload(out, *phase);
    } else if (const auto* change = std::get_if<Signal>(&payload)) {
        out += "signal,";
        put_value(out, change->value);
        out += ',';
        out += signal;
        out += ",,,";
    } else if (const auto* can = std::get_if<CanMessage>(&payload)) {
        put_payload(out, *can);
    } else if (const auto* packet = std::get_if<Packet>(&payload)) {
        put_payload(out, *packet);
    } else {
        put_payload(out, std::get<RadioFrame>(payload));
    }
    out += ',';
    out += fault_name(fault);
}

std::string to_csv(const TraceRow& row) {
    const auto* signal = std::get_if<Signal>(&row.payload);
    std::string text;
    append_row(text, row.time, sender_columns(row.link, row.from), row.payload,
               signal == nullptr ? "" : signal_column(row.signal, signal->id), row.fault);
    return text;
}

TraceRow parse_trace_row(std::string_view text, std::string_view file, std::size_t line) {
    const Parser in(text, file, line);
    TraceRow row;
    row.time = in.time(0);
    row.link = in[1];
    row.from = in[2];
    if (!in[9].empty()) {
        const auto fault = fault_of_name(in[9]);
        if (!fault) in.fail(fmt::format("\"{}\" is no fault", in[9]), "drop, flip, delay, ...");
        row.fault = *fault;
    }
    if (in[3] == "uart" || in[3] == "break")
        row.payload = parse_frame(in);
    else if (in[3] == "i2c")
        row.payload = parse_phase(in);
    else if (in[3] == "signal")
        row.payload = parse_signal(in, row.signal);
    else if (in[3] == "radio")
        row.payload = parse_radio(in);
    else if (in[3] == "can")
        row.payload = parse_can_message(in);
    else if (in[3] == "packet")
        row.payload = parse_packet(in);
    else
        in.fail(fmt::format("\"{}\" is no kind of message", in[3]),
                "uart, break, i2c, signal, radio, can, packet");
    return row;
}

}  // namespace puckloop::cosim
