#include "tests/time_bounds/drawn_faults.h"

#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/spec/flash.h"
#include "scenarios/reader/faults/fault_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace puckloop::tests {

namespace {

using cosim::KindInfo;
using cosim::ParameterInfo;
using cosim::PlaceKind;
using cosim::Style;
using cosim::Unit;
using scenarios::FaultPlace;

/// What resets, stops or cuts off.
constexpr std::array<std::string_view, 12> kEnds{"reset",      "brown_out", "battery", "sag",
                                                 "hang",       "restart",   "kill",    "pause",
                                                 "disconnect", "unplug",    "hang_up", "slave_reset"};
/// Parameters that must fit the image, another parameter or another node; the fault draws what is not given.
constexpr std::array<std::string_view, 10> kLeftOut{"pc",      "nth",   "symbol", "bit",      "to",
                                                    "bearing", "width", "other",  "register", "id"};

template <class List>
bool has(const List& list, std::string_view name) {
    return std::find(std::begin(list), std::end(list), name) != std::end(list);
}

bool is_board(PlaceKind place) {
    return place == PlaceKind::Pic || place == PlaceKind::Rab || place == PlaceKind::Tam;
}

std::string in_quotes(std::string_view text) {
    return fmt::format("\"{}\"", text);
}

std::string text_for(Draw& draw, const KindInfo& kind, const ParameterInfo& parameter) {
    if (parameter.key == "profile") {
        std::string profile = fmt::format("0 s {:.2f} V", draw.uniform(0, 4.2));
        double time = 0;
        for (std::uint64_t i = draw.below(4); i > 0; --i) {
            time += draw.logarithmic(1e-4, 0.3);
            profile += fmt::format(", {:.6f} s {:.2f} V", time, draw.one_in(2) ? 0 : draw.uniform(0, 4.2));
        }
        return in_quotes(profile);
    }
    if (parameter.key == "data")
        return in_quotes(draw.of(std::array{"41", "f2 07 00", "0d0a", "ff 00 ff 00"}));
    if (parameter.key == "vector") {
        if (kind.place == PlaceKind::Tam)
            return in_quotes(draw.of(std::array{"TIMER0_OVF", "TIMER1_COMPA", "USART0_RX", "USART1_RX"}));
        return in_quotes(draw.of(std::array{"T1", "T2", "T3", "U1RX", "U1TX", "U2RX"}));
    }
    std::vector<std::string_view> choices;
    for (std::string_view rest = parameter.choices; !rest.empty();) {
        const std::size_t bar = std::min(rest.find('|'), rest.size());
        choices.push_back(rest.substr(0, bar));
        rest.remove_prefix(std::min(bar + 1, rest.size()));
    }
    if (kind.place == PlaceKind::Rab) std::erase(choices, "eeprom");  // it has none
    return in_quotes(draw.of(choices));
}

std::string integer_for(Draw& draw, const ParameterInfo& parameter) {
    constexpr double kFew = 1000;
    const double least = std::max(parameter.low, 1.0);
    if (parameter.high - parameter.low > kFew)
        return fmt::format("{}", static_cast<std::int64_t>(draw.logarithmic(least, parameter.high)));
    const auto range = static_cast<std::uint64_t>(parameter.high - parameter.low) + 1;
    return fmt::format("{}", static_cast<std::int64_t>(parameter.low) +
                                 static_cast<std::int64_t>(draw.below(range)));
}

/// As the scenario has it.
std::string value_for(Draw& draw, const KindInfo& kind, const ParameterInfo& parameter, double end) {
    constexpr double kNanosecond = 1e-9, kPart = 1e-3;
    const bool wide = parameter.low > 0 && parameter.high / parameter.low > 10;
    switch (parameter.unit) {
    case Unit::Time: {
        const double least = std::max(parameter.low, kNanosecond);
        return quoted_time(draw.logarithmic(least, std::max(least, std::min(parameter.high, end))));
    }
    case Unit::Text:
        return text_for(draw, kind, parameter);
    case Unit::Integer:
        return integer_for(draw, parameter);
    case Unit::Byte:
        if (kind.place == PlaceKind::I2c && draw.one_in(2))
            return fmt::format("{}", draw.of(std::array{0x20, 0x60, 0x61}));  // boards on the robot's bus
        return fmt::format("{}", draw.below(static_cast<std::uint64_t>(parameter.high) + 1));
    case Unit::Flag:
        return draw.one_in(2) ? "true" : "false";
    case Unit::Voltage:
        return fmt::format("\"{:.3f} V\"", draw.uniform(parameter.low, parameter.high));
    default:
        if (wide) return fmt::format("{:.6f}", draw.logarithmic(parameter.low, parameter.high));
        return fmt::format("{:.6f}", draw.uniform(parameter.low, parameter.high * (1 - kPart)));
    }
}

std::string parameters_of(Draw& draw, const KindInfo& kind, double end) {
    // Of these the phase decides what else is allowed.
    constexpr std::array<std::string_view, 4> kAnyPhase{"stretch", "sda", "scl", "slave_reset"};
    std::string text;
    std::optional<double> delay;
    for (const ParameterInfo& parameter : kind.parameters) {
        const bool fits_others = has(kLeftOut, parameter.key) && !parameter.required;
        if (fits_others || (is_board(kind.place) && parameter.key == "address")) continue;
        if (parameter.key == "position") continue;
        if (parameter.key == "phase" && !has(kAnyPhase, kind.name)) continue;
        if (!parameter.required && draw.one_in(3)) continue;
        std::string value;
        if (parameter.key == "delay") {
            delay = std::max(parameter.low, draw.logarithmic(1e-6, end));
            value = quoted_time(*delay);
        } else if (parameter.key == "jitter" && delay) {
            value = quoted_time(*delay * draw.uniform(0, 0.9));
        } else {
            value = value_for(draw, kind, parameter, end);
        }
        text += fmt::format("{} = {}\n", parameter.key, value);
    }
    return text;
}

std::string when(Draw& draw, const KindInfo& kind, double end) {
    const std::string at = fmt::format("at = {}\n", draw.time(0, end)),
                      begin = fmt::format("begin = {}\n", draw.time(0, end)),
                      window = begin + fmt::format("for = {}\n", quoted_time(draw.logarithmic(1e-6, end)));
    if (kind.style == Style::Hold) return window;
    if (kind.style == Style::Times) {
        if (draw.one_in(2)) return at;
        return begin + fmt::format("period = {}\ncount = {}\n", quoted_time(draw.logarithmic(1e-3, end)),
                                   1 + draw.below(4));
    }
    if (draw.one_in(3)) return at;
    switch (draw.below(4)) {
    case 0:
        return window;
    case 1:
        return window + fmt::format("probability = {:.3f}\n", draw.uniform(0.01, 1));
    case 2:
        if (kind.mark == cosim::FaultKind::Cut) return window;
        return window + fmt::format("p = {:.3f}\nr = {:.3f}\n", draw.uniform(0.01, 1), draw.uniform(0.1, 1));
    default:
        if (kind.mark == cosim::FaultKind::Cut) return window;
        return window + fmt::format("skip = {}\nevery = {}\ncount = {}\n", draw.below(10), 1 + draw.below(5),
                                    1 + draw.below(20));
    }
}

std::string drawn_fault(Draw& draw, const FaultPlace& place, double end) {
    std::vector<const KindInfo*> kinds, ends;
    for (const KindInfo& kind : cosim::all_kinds())
        if (kind.place == place.kind && kind.name != cosim::kFlashKind) {  // needs an image for the board
            kinds.push_back(&kind);
            if (has(kEnds, kind.name)) ends.push_back(&kind);
        }
    const KindInfo& kind = *(!ends.empty() && draw.one_in(2) ? draw.of(ends) : draw.of(kinds));
    std::string text = fmt::format("[[fault]]\n{} = \"{}\"\nkind = \"{}\"\nmay_not_fire = true\n",
                                   place.is_node ? "node" : "link", place.name, kind.name);
    const bool of_all = kind.mark == cosim::FaultKind::SwappedWires ||
                        (kind.place == PlaceKind::Xbee && kind.name == "clash") ||
                        kind.name == "weak_emitter" || kind.name == "weak_receiver";
    if (!place.ends.empty() && !of_all && draw.one_in(3))
        text += fmt::format("from = \"{}\"\n", draw.of(place.ends));
    return text + when(draw, kind, end) + parameters_of(draw, kind, end);
}

}  // namespace

std::string drawn_faults(Draw& draw, const scenarios::Scenario& scenario, double end) {
    const std::vector<FaultPlace> places = scenarios::fault_places(scenario);
    std::vector<FaultPlace> nodes;
    for (const FaultPlace& place : places)
        if (is_board(place.kind) || place.kind == PlaceKind::Linux) nodes.push_back(place);
    std::string text;
    for (std::uint64_t i = 2 + draw.below(7); i > 0; --i)
        text += drawn_fault(draw, draw.of(!nodes.empty() && draw.one_in(2) ? nodes : places), end);
    return text;
}

}  // namespace puckloop::tests
