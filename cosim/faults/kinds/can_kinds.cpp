// What can happen on a CAN bus (carried out by cosim/can).

#include "cosim/faults/kinds/kind_table.h"

namespace puckloop::cosim {

std::vector<KindInfo> can_kinds() {
    constexpr double kHighestId = (1 << 29) - 1;
    constexpr double kLastBit = 123;  // of the longest frame, behind the arbitration field
    const ParameterInfo to{"to", Unit::Text};
    const ParameterInfo id{"id", Unit::Integer, 0, kHighestId};
    const auto kind = [](std::string_view name, Style style, std::vector<ParameterInfo> parameters,
                         std::string_view alias = {}) {
        return KindInfo{name, PlaceKind::Can, style, FaultKind::None, std::move(parameters), alias};
    };
    return {
        kind("drop", Style::Each, {to, id}, "loss"),
        kind("flip", Style::Each, {to, id, {"bit", Unit::Integer, 0, kLastBit}}, "corrupt"),
        kind("stuck", Style::Hold, {{"level", Unit::Text, 0, 0, {}, false, "dominant|recessive"}}),
        kind("disconnect", Style::Hold, {}),
    };
}

}  // namespace puckloop::cosim
