#include "cosim/faults/kinds/kind_table.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace puckloop::cosim {

namespace {

std::string_view first_choice(std::string_view choices) {
    return choices.substr(0, choices.find('|'));
}

bool is_choice(std::string_view choices, std::string_view text) {
    if (choices.empty()) return true;
    while (true) {
        const std::size_t bar = choices.find('|');
        if (choices.substr(0, bar) == text) return true;
        if (bar == std::string_view::npos) return false;
        choices.remove_prefix(bar + 1);
    }
}

bool in_range(const ParameterInfo& parameter, double value) {
    switch (parameter.unit) {
    case Unit::Flag:
        return value == 0.0 || value == 1.0;
    case Unit::Byte:
        return value >= 0.0 && value <= 255.0 && value == std::floor(value);
    case Unit::Integer:
        return value >= parameter.low && value <= parameter.high && value == std::floor(value);
    default:
        return value >= parameter.low && value <= parameter.high;
    }
}

/// Where faults that hold do so for everything; on lines each frame is a candidate.
bool carries_out_by_window(PlaceKind place) {
    return place == PlaceKind::Pic || place == PlaceKind::Rab || place == PlaceKind::Tam ||
           place == PlaceKind::InfraRed || place == PlaceKind::Linux || place == PlaceKind::Xbee ||
           place == PlaceKind::Can || place == PlaceKind::Network;
}

}  // namespace

const std::vector<KindInfo>& all_kinds() {
    static const std::vector<KindInfo> kinds = [] {
        std::vector<KindInfo> all;
        for (auto family : {uart_kinds, radio_kinds, xbee_kinds, ircom_kinds, i2c_kinds, can_kinds,
                            linux_kinds, board_kinds, infrared_kinds, network_kinds}) {
            std::vector<KindInfo> some = family();
            std::move(some.begin(), some.end(), std::back_inserter(all));
        }
        return all;
    }();
    return kinds;
}

const KindInfo* find_kind(std::string_view name, PlaceKind place) {
    for (const KindInfo& kind : all_kinds())
        if (kind.place == place && (kind.name == name || (!kind.alias.empty() && kind.alias == name)))
            return &kind;
    return nullptr;
}

std::string kinds_of(PlaceKind place) {
    std::string names;
    for (const KindInfo& kind : all_kinds())
        if (kind.place == place) names += fmt::format("{}{}", names.empty() ? "" : ", ", kind.name);
    return names;
}

void complete(FaultSpec& spec, const KindInfo& kind) {
    spec.kind = kind.name;
    for (const ParameterInfo& parameter : kind.parameters) {
        if (spec.parameters.has(parameter.key)) continue;
        if (parameter.unit == Unit::Text && !parameter.choices.empty())
            spec.set(parameter.key, first_choice(parameter.choices));
        else if (parameter.fallback)
            spec.set(parameter.key, *parameter.fallback);
    }
}

void check_fault(const FaultSpec& spec, const KindInfo& kind) {
    const bool on_link = !spec.link.empty();
    const auto refuse = [&](const std::string& what, const std::string& expected) {
        throw InputError(
            "", fmt::format("fault on {} {}", on_link ? "link" : "node", on_link ? spec.link : spec.node),
            what, expected);
    };
    const auto check_share = [&](double share, const char* what) {
        if (!(share >= 0.0 && share <= 1.0)) refuse(fmt::format("bad {}", what), "0 to 1");
    };
    check_share(spec.probability, "probability");
    if (spec.burst) {
        check_share(spec.burst->p, "p");
        check_share(spec.burst->r, "r");
        check_share(spec.burst->bad, "1-h");
        check_share(spec.burst->good, "1-k");
    }
    if (spec.begin < 0 || spec.end <= spec.begin) refuse("empty time window", "0 <= begin < end");
    if (spec.every == 0) refuse("bad every", "1 or more");
    if (spec.period < 0) refuse("bad period", "0 or more");
    for (const ParameterInfo& parameter : kind.parameters) {
        const auto number = spec.parameters.numbers.find(parameter.key);
        if (number != spec.parameters.numbers.end() && !in_range(parameter, number->second))
            refuse(fmt::format("bad {} of {}", parameter.key, kind.name),
                   fmt::format("{:g} to {:g}", parameter.low, parameter.high));
        const auto text = spec.parameters.texts.find(parameter.key);
        if (text != spec.parameters.texts.end() && !is_choice(parameter.choices, text->second))
            refuse(fmt::format("bad {} of {}", parameter.key, kind.name), std::string(parameter.choices));
        if (parameter.required && !spec.parameters.has(parameter.key))
            refuse(fmt::format("{} without {}", kind.name, parameter.key), std::string(parameter.key));
    }
    const auto belongs = [&](const std::string& key) {
        return std::any_of(kind.parameters.begin(), kind.parameters.end(),
                           [&](const ParameterInfo& parameter) { return parameter.key == key; });
    };
    for (const auto& [key, value] : spec.parameters.numbers)
        if (!belongs(key)) refuse(fmt::format("{} has no {}", kind.name, key), "one of its own parameters");
    for (const auto& [key, value] : spec.parameters.texts)
        if (!belongs(key)) refuse(fmt::format("{} has no {}", kind.name, key), "one of its own parameters");
    if (kind.place == PlaceKind::Uart) check_uart_fault(spec, kind);
    const bool delays_frames = kind.place == PlaceKind::Radio || kind.place == PlaceKind::Network;
    if (delays_frames && spec.parameters.number("jitter") > spec.parameters.number("delay"))
        refuse("the jitter is larger than the delay", "frames that are not early");
    if (kind.place == PlaceKind::Ircom && kind.name == "flip") {
        constexpr double kBits = 10;
        if (spec.parameters.number("bit") + spec.parameters.number("bits") > kBits)
            refuse("no word has so many bits", "bit + bits of at most 10");
    }
    if (kind.style == Style::Hold && carries_out_by_window(kind.place) &&
        (spec.probability != 1.0 || spec.count != ~0ull))
        refuse(fmt::format("{} holds during its whole window", kind.name), "neither probability nor count");
    check_board_fault(spec, kind);
}

}  // namespace puckloop::cosim
