#include "ends/scripts.h"

#include "base/error.h"
#include "base/suggest.h"
#include "ends/text_input.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::exec {

namespace {

constexpr std::uint32_t kHighestAddress = 0x7F;
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
std::uint8_t bus_address(std::string_view file, const TextLine& line, std::string_view word) {
    if (!word.starts_with("0x") && !word.starts_with("0X"))
        wrong_shape(file, line, fmt::format("'{}' is not a 7-bit address", readable(word)),
                    "hexadecimal after 0x, such as 0x20");
    return static_cast<std::uint8_t>(
        parse_integer(file, line.number, word, "7-bit address", kHighestAddress));
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
        "<time_s> w <addr> <hex bytes>, or <time_s> r <addr> <register> <count>";
    std::vector<I2cScriptLine> script;
    for (const TextLine& line : split_lines(text)) {
        if (line.words.size() < 4) wrong_shape(file, line, "too short", kShape);
        I2cScriptLine entry;
        entry.line = line.number;
        entry.time = parse_time(file, line.number, line.words[0]);
        entry.address = bus_address(file, line, line.words[2]);
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
