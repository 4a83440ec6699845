#include "cosim/faults/spec/fault_kind.h"

#include <algorithm>
#include <array>

namespace puckloop::cosim {

namespace {
constexpr std::array<std::string_view, 29> kFaultNames{
    "",         "drop",   "flip", "delay",         "duplicate",   "disconnect",
    "stuck",    "rate",   "cut",  "insert",        "held",        "swap",
    "truncate", "parity", "stop", "glitch",        "false_start", "break",
    "invert",   "unplug", "torn", "swapped_wires", "batch",       "throttle",
    "overflow", "stall",  "late", "baud",          "loopback"};
static_assert(kFaultNames.size() == static_cast<std::size_t>(FaultKind::Loopback) + 1);
}  // namespace

std::string_view fault_name(FaultKind kind) {
    return kFaultNames.at(static_cast<std::size_t>(kind));
}

std::optional<FaultKind> fault_of_name(std::string_view name) {
    const auto* found = std::find(kFaultNames.begin() + 1, kFaultNames.end(), name);
    if (found == kFaultNames.end()) return std::nullopt;
    return static_cast<FaultKind>(found - kFaultNames.begin());
}

}  // namespace puckloop::cosim
