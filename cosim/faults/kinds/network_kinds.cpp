// What can happen to packets of a network (carried out by emu/network), by the names of tc-netem.

#include "cosim/faults/kinds/kind_table.h"

namespace puckloop::cosim {

std::vector<KindInfo> network_kinds() {
    constexpr double kLongest = 10.0;  // s
    constexpr double kMostBits = 8 * 1500;
    constexpr double kReachable = 30.0;    // s: Linux, neigh/default/base_reachable_time
    constexpr double kFarthestByte = 2e9;  // half of TCP's sequence numbers
    const auto kind = [](std::string_view name, Style style, std::vector<ParameterInfo> parameters,
                         std::string_view alias = {}) {
        return KindInfo{name, PlaceKind::Network, style, FaultKind::None, std::move(parameters), alias};
    };
    const ParameterInfo to{"to", Unit::Text};
    return {
        kind("loss", Style::Each, {to}, "drop"),
        kind("duplicate", Style::Each, {to}),
        kind("delay", Style::Each,
             {to, {"delay", Unit::Time, 0, kLongest, {}, true}, {"jitter", Unit::Time, 0, kLongest, 0.0}}),
        kind("reorder", Style::Each, {to, {"delay", Unit::Time, 1e-6, kLongest, 0.01}}),
        kind("corrupt", Style::Each, {to, {"bits", Unit::Integer, 1, kMostBits, 1.0}}, "flip"),
        kind("partition", Style::Hold, {to, {"group", Unit::Text}}),
        kind("rate", Style::Hold, {{"rate", Unit::Number, 1000, 1e11, {}, true}}),
        kind("access_point_away", Style::Hold, {}),
        kind("address_clash", Style::Hold,
             {to,
              {"share", Unit::Ratio, 0, 1, 0.5},
              {"cache", Unit::Time, 0.001, 3600, kReachable},
              {"answers", Unit::Text, 0, 0, {}, false, "reset|nothing"}}),
        kind("connection_reset", Style::Each, {to, {"byte", Unit::Integer, 0, kFarthestByte, 0.0}}),
    };
}

}  // namespace puckloop::cosim
