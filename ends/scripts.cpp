#include "ends/scripts.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "ends/text_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::exec {

namespace {

constexpr std::uint32_t kHighestAddress = 0x7F;
constexpr std::uint32_t kHighestOfTen = 0x3FF;
constexpr std::string_view kTen = "ten:";
constexpr std::uint32_t kLongestRead = 256;
constexpr std::size_t kShownOfName = 40;

template <typename Line>
void sort_by_time(std::vector<Line>& lines) {
    std::stable_sort(lines.begin(), lines.end(),
                     [](const Line& a, const Line& b) { return a.time < b.time; });
}

[[noreturn]] void wrong_shape(std::string_view file, const TextLine& line, std::string_view problem,
                              std::string_view expected) {
    throw InputError(file, fmt::format("line {}", line.number), problem, expected);
}

std::string readable(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, kShownOfName))
        text += c >= ' ' && c <= '~' ? c : '?';
    return text;
}

std::uint16_t signal_named(std::string_view file, const TextLine& line,
                           std::span<const cosim::SignalInfo> signals) {
    const std::string_view name = line.words[1];
    if (const auto id = cosim::find_signal(signals, name)) {
        if (signals[*id].direction == cosim::SignalDirection::Output)
            wrong_shape(file, line, fmt::format("signal '{}' is an output of the board", name), "an input");
        return *id;
    }
    std::string expected = "one of --list-signals";
    std::vector<std::string_view> known;
    for (const cosim::SignalInfo& info : signals)
        if (info.direction == cosim::SignalDirection::Input) known.push_back(info.name);
    const std::string near = nearest_name(name.substr(0, kShownOfName), known);
    if (!near.empty()) expected += fmt::format("; did you mean {}?", near);
    wrong_shape(file, line, fmt::format("no signal '{}'", readable(name)), expected);
}

/// Hexadecimal after 0x only: data sheets write addresses so, and a bare 20 would be taken for one or the
/// other.
std::uint16_t bus_address(std::string_view file, const TextLine& line, std::string_view word, bool ten_bits) {
    if (!word.starts_with("0x") && !word.starts_with("0X"))
        wrong_shape(file, line,
                    fmt::format("'{}' is not a {}-bit address", readable(word), ten_bits ? 10 : 7),
                    "hexadecimal after 0x, such as 0x20");
    return static_cast<std::uint16_t>(parse_integer(file, line.number, word,
                                                    ten_bits ? "10-bit address" : "7-bit address",
                                                    ten_bits ? kHighestOfTen : kHighestAddress));
}

/// The byte that two hexadecimal digits are.
std::optional<std::uint8_t> byte_of(std::string_view digits) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (digits.size() != 2 || error != std::errc{} || end != digits.data() + digits.size()) return {};
    return static_cast<std::uint8_t>(value);
}

I2cRawStep raw_step(std::string_view file, const TextLine& line, std::string_view word) {
    constexpr std::string_view kSteps = "sXX, wXX, r, n or p, hexadecimal; /1 to /7 after all but p";
    const auto wrong = [&] {
        wrong_shape(file, line, fmt::format("'{}' is no step of a master", readable(word)), kSteps);
    };
    I2cRawStep step;
    const std::string_view whole = word.substr(0, word.find('/'));
    if (whole.size() != word.size()) {
        const std::string_view clocks = word.substr(whole.size() + 1);
        if (clocks.size() != 1 || clocks[0] < '1' || clocks[0] > '7' || whole == "p") wrong();
        step.clocks = clocks[0] - '0';
    }
    if (whole == "r" || whole == "n") {
        step.kind = I2cRawStep::Kind::Read;
        step.acknowledge = whole == "r";
    } else if (whole != "p") {
        const auto byte = byte_of(whole.substr(whole.empty() ? 0 : 1));
        if (!byte || (whole[0] != 's' && whole[0] != 'w')) wrong();
        step.kind = whole[0] == 's' ? I2cRawStep::Kind::Start : I2cRawStep::Kind::Write;
        step.byte = *byte;
    }
    return step;
}

std::vector<I2cRawStep> raw_steps(std::string_view file, const TextLine& line) {
    using Kind = I2cRawStep::Kind;
    std::vector<I2cRawStep> steps;
    for (std::size_t i = 2; i < line.words.size(); ++i)
        steps.push_back(raw_step(file, line, line.words[i]));
    if (steps.front().kind != Kind::Start) wrong_shape(file, line, "a master begins with a START", "sXX");
    if (steps.back().kind != Kind::Stop)
        wrong_shape(file, line, "the master keeps the bus for good", "p as the last step");
    for (std::size_t i = 1; i < steps.size(); ++i) {
        const bool ends = steps[i].kind == Kind::Start || steps[i].kind == Kind::Stop;
        if (steps[i - 1].clocks < 9 && !ends)
            wrong_shape(file, line, "a byte that is broken off is followed by another",
                        "a START or STOP, which breaks it off");
        if (steps[i - 1].kind == Kind::Stop && steps[i].kind != Kind::Start)
            wrong_shape(file, line, "a byte without a START before it", "sXX after p");
    }
    return steps;
}

}  // namespace

std::vector<UartScriptLine> parse_uart_script(std::string_view file, std::string_view text) {
    std::vector<UartScriptLine> script;
    for (const TextLine& line : split_lines(text)) {
        if (line.words.size() < 2) wrong_shape(file, line, "too short", "<time_s> <hex bytes>");
        script.push_back({parse_time(file, line.number, line.words[0]), parse_hex_bytes(file, line, 1)});
    }
    sort_by_time(script);
    return script;
}

std::vector<I2cScriptLine> parse_i2c_script(std::string_view file, std::string_view text) {
    constexpr std::string_view kShape =
        "<time_s> w <addr> <hex bytes>, <time_s> r <addr> <register> <count> or <time_s> raw <steps>";
    std::vector<I2cScriptLine> script;
    for (const TextLine& line : split_lines(text)) {
        const bool raw = line.words.size() > 2 && line.words[1] == "raw";
        if (line.words.size() < 4 && !raw) wrong_shape(file, line, "too short", kShape);
        I2cScriptLine entry;
        entry.line = line.number;
        entry.time = parse_time(file, line.number, line.words[0]);
        if (raw) {
            entry.raw = raw_steps(file, line);
            script.push_back(std::move(entry));
            continue;
        }
        std::string_view address = line.words[2];
        entry.ten_bits = address.starts_with(kTen);
        if (entry.ten_bits) address.remove_prefix(kTen.size());
        entry.address = bus_address(file, line, address, entry.ten_bits);
        if (line.words[1] == "w") {
            entry.bytes = parse_hex_bytes(file, line, 3);
        } else if (line.words[1] == "r") {
            if (line.words.size() != 5) wrong_shape(file, line, "wrong number of words", kShape);
            entry.read = true;
            if (line.words[3] != "-")
                entry.register_number = static_cast<std::uint8_t>(
                    parse_integer(file, line.number, line.words[3], "register", 0xFF));
            entry.count =
                static_cast<int>(parse_integer(file, line.number, line.words[4], "count", kLongestRead));
            if (entry.count == 0) wrong_shape(file, line, "count 0", "1 to 256 bytes");
        } else {
            wrong_shape(file, line, "neither a write nor a read", kShape);
        }
        script.push_back(std::move(entry));
    }
    sort_by_time(script);
    return script;
}

std::vector<StimulusLine> parse_stimulus(std::string_view file, std::string_view text,
                                         std::span<const cosim::SignalInfo> signals) {
    std::vector<StimulusLine> script;
    for (const TextLine& line : split_lines(text)) {
        if (line.words.size() != 3)
            wrong_shape(file, line, "wrong number of words", "<time_s> <signal> <value>");
        StimulusLine entry;
        entry.time = parse_time(file, line.number, line.words[0]);
        if (line.words[1] == "reset" && !cosim::find_signal(signals, "reset")) {
            if (line.words[2] != "1")
                wrong_shape(file, line, "the reset button is pressed, not held", "reset 1");
            entry.signal = StimulusLine::kReset;
            entry.value = 1.0;
            script.push_back(entry);
            continue;
        }
        entry.signal = signal_named(file, line, signals);
        const cosim::SignalInfo& info = signals[entry.signal];
        entry.value = parse_number(file, line.number, line.words[2], info.name, info.min, info.max);
        if (info.unit == "level" && entry.value != info.min && entry.value != info.max)
            wrong_shape(file, line, fmt::format("{} is a level, not {}", info.name, line.words[2]),
                        fmt::format("{} or {}", info.min, info.max));
        script.push_back(entry);
    }
    sort_by_time(script);
    return script;
}

}  // namespace puckloop::exec
