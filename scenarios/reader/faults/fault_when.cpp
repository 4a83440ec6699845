#include "scenarios/reader/faults/fault_when.h"

#include "base/error.h"

#include <fmt/format.h>

#include <charconv>
#include <vector>

namespace puckloop::scenarios {

using cosim::FaultSpec;
using cosim::KindInfo;
using cosim::Style;

/// 0..255 in decimal or 0x..
std::uint8_t byte_of(Reader& reader, std::string_view key, const std::string& text) {
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    const char* const first = text.data() + (hexadecimal ? 2 : 0);
    const char* const last = text.data() + text.size();
    std::uint8_t value = 0;
    const auto [end, error] = std::from_chars(first, last, value, hexadecimal ? 16 : 10);
    if (error != std::errc() || end != last)
        reader.fail(key, fmt::format("'{}' is not a byte", text), "such as \"0x7F\" or \"127\"");
    return value;
}

namespace {

constexpr double kLatest = 9e6;  // seconds that simulated time can carry
constexpr std::int64_t kMost = 1'000'000'000;

/// bytes = ["0x00", "0xFF"].
std::vector<std::uint8_t> read_bytes(Reader& reader) {
    std::vector<std::uint8_t> bytes;
    for (const std::string& text : reader.texts("bytes"))
        bytes.push_back(byte_of(reader, "bytes", text));
    if (bytes.empty())
        reader.fail("bytes", "bytes is empty", "such as [\"0x00\", \"0xFF\"], or no 'bytes' for all");
    return bytes;
}

/// match = "f2 07".
std::vector<std::uint8_t> read_pattern(Reader& reader) {
    std::vector<std::uint8_t> pattern;
    std::string text = reader.text("match");
    std::erase(text, ' ');
    constexpr std::size_t kLongestPattern = 64;
    bool good = !text.empty() && text.size() % 2 == 0 && text.size() <= 2 * kLongestPattern;
    for (std::size_t i = 0; good && i < text.size(); i += 2) {
        const char* const digits = text.data() + i;
        good = std::from_chars(digits, digits + 2, pattern.emplace_back(), 16).ptr == digits + 2;
    }
    if (!good)
        reader.fail("match", "match is no pattern",
                    "two hex digits a byte, such as \"f2 07\", at most 64 bytes");
    return pattern;
}

cosim::Time read_time(Reader& reader, std::string_view key) {
    const double seconds = reader.quantity(key, Dimension::Time);
    if (!(seconds >= 0 && seconds <= kLatest))
        reader.fail(key, fmt::format("{} is out of range", key), "0 s to 9e6 s");
    return cosim::from_seconds(seconds);
}

double read_share(Reader& reader, std::string_view key, double fallback) {
    const double share = reader.quantity(key, Dimension::Ratio, fallback);
    if (!(share >= 0 && share <= 1))
        reader.fail(key, fmt::format("{} is out of range", key), "0 to 1, or \"5 %\"");
    return share;
}

/// begin and end, or at, or for instead of end.
void read_window(Reader& reader, const KindInfo& kind, FaultSpec& fault) {
    const bool at = reader.has("at");
    if (at && reader.has("begin")) reader.fail("at", "both at and begin are given", "one of them");
    if (at)
        fault.begin = read_time(reader, "at");
    else if (reader.has("begin"))
        fault.begin = read_time(reader, "begin");
    if (reader.has("end") && reader.has("for"))
        reader.fail("for", "both end and for are given", "one of them");
    if (reader.has("for"))
        fault.end = cosim::later(fault.begin, read_time(reader, "for"));
    else if (reader.has("end"))
        fault.end = read_time(reader, "end");
    if (fault.end <= fault.begin) reader.fail("begin", "the fault's window is empty", "0 s <= begin < end");
    if (at && kind.style == Style::Each && !reader.has("count") && fault.end == cosim::kNever)
        fault.count = 1;
}

void read_burst(Reader& reader, FaultSpec& fault) {
    if (!reader.has("p")) return;
    if (reader.has("probability"))
        reader.fail("p", "both a burst and a probability are given", "one of them");
    cosim::Burst burst;
    burst.p = read_share(reader, "p", 0.0);
    burst.r = read_share(reader, "r", 1.0 - burst.p);
    burst.bad = read_share(reader, "1-h", 1.0);
    burst.good = read_share(reader, "1-k", 0.0);
    fault.burst = burst;
}

}  // namespace

void read_when(Reader& reader, const KindInfo& kind, FaultSpec& fault) {
    if (reader.has("count")) fault.count = static_cast<std::uint64_t>(reader.integer("count", 1, 1, kMost));
    read_window(reader, kind, fault);
    if (kind.style == Style::Hold) {
        // As before there were bursts and the like: of a plug, each frame.
        fault.probability = read_share(reader, "probability", 1.0);
        return;
    }
    fault.probability = read_share(reader, "probability", 1.0);
    if (kind.style == Style::Times && reader.has("period")) {
        fault.period = read_time(reader, "period");
        if (fault.period <= 0) reader.fail("period", "period is out of range", "more than 0 s");
    }
    if (kind.mark == cosim::FaultKind::Cut) return;
    read_burst(reader, fault);
    fault.skip = static_cast<std::uint64_t>(reader.integer("skip", 0, 0, kMost));
    fault.every = static_cast<std::uint64_t>(reader.integer("every", 1, 1, kMost));
}

void read_match(Reader& reader, const KindInfo& kind, FaultSpec& fault) {
    if (kind.style == Style::Times || kind.mark == cosim::FaultKind::Cut) return;
    const bool uart = kind.place == cosim::PlaceKind::Uart;
    const bool air = kind.place == cosim::PlaceKind::Radio || kind.place == cosim::PlaceKind::Xbee ||
                     kind.place == cosim::PlaceKind::Network;
    if (!uart && !air) return;
    if (kind.mark == cosim::FaultKind::Truncate) return;
    if (uart && reader.has("bytes")) fault.bytes = read_bytes(reader);
    if (kind.style == Style::Hold) return;
    if (uart && reader.has("position"))
        fault.position = static_cast<std::uint32_t>(reader.integer("position", 0, 0, kMost));
    if (!reader.has("match")) return;
    fault.match = read_pattern(reader);
    // Of `baud`, which has an offset of its own, the frame that completes the pattern suffers.
    const bool own_offset = std::any_of(kind.parameters.begin(), kind.parameters.end(),
                                        [](const auto& parameter) { return parameter.key == "offset"; });
    if (uart && !own_offset) fault.offset = static_cast<std::uint32_t>(reader.integer("offset", 0, 0, kMost));
}

}  // namespace puckloop::scenarios
