// The kinds of faults of a UART's line and their parameters; docs/scenario.md explains them.

#include "base/error.h"
#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/spec/typed_bytes.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

namespace {

constexpr double kLongestOfLine = 1e6;  // seconds
// A bit slower than 1/64 or faster than 64 times the sender's is no clock error but a mistake.
constexpr double kMostRateFactor = 64.0;
constexpr double kMostFrames = 1e6;
constexpr double kMostBitsOfFrame = 13;  // start, 9 data, parity, 2 stop

ParameterInfo required(std::string_view key, Unit unit, double low, double high) {
    return {key, unit, low, high, {}, true};
}
ParameterInfo optional(std::string_view key, Unit unit, double low, double high) {
    return {key, unit, low, high};
}
ParameterInfo choice(std::string_view key, std::string_view choices) {
    return {key, Unit::Text, 0, 0, {}, false, choices};
}

KindInfo kind(std::string_view name, Style style, FaultKind mark, std::vector<ParameterInfo> parameters = {},
              std::string_view alias = {}) {
    return {name, PlaceKind::Uart, style, mark, std::move(parameters), alias};
}

}  // namespace

void check_uart_fault(const FaultSpec& spec, const KindInfo& kind) {
    constexpr double kMostInstants = 1e5;
    constexpr int kMostBits = 9;
    const FaultParameters& given = spec.parameters;
    const auto refuse = [&](const std::string& what, const char* expected) {
        throw InputError("", fmt::format("fault on link {}", spec.link), what, expected);
    };
    if (kind.mark == FaultKind::Stall && spec.end == kNever)
        refuse("a stall without an end", "'end' or 'for'");
    const bool whole =
        kind.mark == FaultKind::Unplug || kind.mark == FaultKind::Invert || kind.mark == FaultKind::Loopback;
    if (whole && (spec.probability != 1.0 || spec.count != ~0ull || !spec.bytes.empty()))
        refuse(fmt::format("{} holds during its whole window", kind.name),
               "neither probability nor count nor bytes");
    if (kind.mark == FaultKind::SwappedWires && !spec.from.empty())
        refuse("swapped wires have no direction", "no 'from'");
    if (kind.mark == FaultKind::Baud && given.number("offset") == 0 && given.number("drift") == 0)
        refuse("baud changes nothing", "'offset' or 'drift'");
    if (kind.mark == FaultKind::Flip && given.number("bit") + given.number("bits") > kMostBits)
        refuse("no frame has so many bits", "bit + bits of at most 9");
    if (kind.mark == FaultKind::Delay && given.number("jitter") > given.number("delay"))
        refuse("the jitter is larger than the delay", "frames that are not early");
    const std::size_t typed = kind.name == kTypedKind ? typed_bytes(given.text("data")).size() : 1;
    if (typed == 0)
        refuse(fmt::format("data '{}' are no bytes", given.text("data")),
               "pairs of hexadecimal digits, such as \"64 2c 0d\"");
    if (typed > kMostTyped) refuse(fmt::format("{} bytes of data are too many", typed), "at most 100000");
    if (kind.style != Style::Times || spec.period == 0) return;
    const double span = spec.end == kNever
                            ? kMostInstants + 1
                            : static_cast<double>(spec.end - spec.begin) / static_cast<double>(spec.period);
    const double most =
        spec.probability < 1 || spec.burst ? kMostInstants + 1 : static_cast<double>(spec.count);
    if (std::min(span, most) * static_cast<double>(typed) > kMostInstants)
        refuse(fmt::format("{} happens too often", kind.name),
               "'end', 'for' or 'count', at most 100000 instants, or bytes that are typed");
}

std::vector<KindInfo> uart_kinds() {
    return {
        // Bytes
        kind("drop", Style::Each, FaultKind::Drop, {}, "loss"),
        kind("flip", Style::Each, FaultKind::Flip,
             {{"bits", Unit::Integer, 1, 9, 1},
              optional("bit", Unit::Integer, 0, 8),
              {"burst", Unit::Flag, 0, 1, 0}},
             "corrupt"),
        kind("duplicate", Style::Each, FaultKind::Duplicate),
        kind("insert", Style::Each, FaultKind::Insert, {optional("value", Unit::Byte, 0, 255)}),
        kind("swap", Style::Each, FaultKind::Swap, {}, "reorder"),
        kind(kTypedKind, Style::Times, FaultKind::Insert,
             {{"data", Unit::Text, 0, 0, {}, true}, optional("baud", Unit::Number, 50, 4e6)}),
        // Records
        kind("cut", Style::Each, FaultKind::Cut, {{"again", Unit::Ratio, 0, 1, 0}}),
        kind("truncate", Style::Each, FaultKind::Truncate, {required("keep", Unit::Integer, 0, 1e6)}),
        // Levels
        kind("parity", Style::Each, FaultKind::Parity, {choice("mode", "wrong|mark|space")}),
        kind("stop", Style::Each, FaultKind::Stop, {{"length", Unit::Ratio, 0, 0.99, 0}}),
        kind("glitch", Style::Each, FaultKind::Glitch,
             {required("width", Unit::Time, 1e-9, 1), optional("bit", Unit::Number, 0, kMostBitsOfFrame)}),
        kind("false_start", Style::Times, FaultKind::FalseStart, {required("width", Unit::Time, 1e-9, 1)}),
        kind("break", Style::Times, FaultKind::Break, {optional("length", Unit::Time, 1e-6, 10)}),
        kind("stuck", Style::Hold, FaultKind::Stuck, {choice("level", "low|high")}),
        kind("invert", Style::Hold, FaultKind::Invert),
        // Timing
        kind(
            "delay", Style::Each, FaultKind::Delay,
            {required("delay", Unit::Time, 0, kLongestOfLine), {"jitter", Unit::Time, 0, kLongestOfLine, 0}}),
        kind("rate", Style::Each, FaultKind::Rate,
             {required("factor", Unit::Ratio, 1 / kMostRateFactor, kMostRateFactor)}),
        kind("baud", Style::Each, FaultKind::Baud,
             {{"offset", Unit::Ratio, -0.9, 9, 0}, {"drift", Unit::Ratio, -1, 1, 0}}),
        kind("batch", Style::Each, FaultKind::Batch, {required("slot", Unit::Time, 1e-6, 10)}),
        kind("throttle", Style::Each, FaultKind::Throttle,
             {required("rate", Unit::Number, 1, 1e9), {"limit", Unit::Integer, 0, kMostFrames, 0}}),
        kind("stall", Style::Hold, FaultKind::Stall),
        // Wiring
        kind("disconnect", Style::Hold, FaultKind::Disconnect),
        kind("unplug", Style::Hold, FaultKind::Unplug),
        kind("swapped_wires", Style::Hold, FaultKind::SwappedWires),
        kind("loopback", Style::Hold, FaultKind::Loopback, {{"through", Unit::Flag, 0, 1, 0}}),
    };
}

}  // namespace puckloop::cosim
