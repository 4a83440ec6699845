#include "cosim/faults/kinds/kind_facts.h"

#include <algorithm>
#include <array>

namespace puckloop::cosim {

namespace {

constexpr std::string_view kNotRunning = "its program was not running then";
constexpr std::string_view kNoByte =
    "no byte that it is for was on the bus while it held the line (without address, register, phase or "
    "position it holds it once, from its begin on)";

struct KindFacts {
    std::string_view name;
    std::string_view silent{};
    bool battery = false;
};

/// By name: each of these is of one family of places.
constexpr std::array kFacts{
    KindFacts{"pause", kNotRunning},
    KindFacts{"kill", kNotRunning},
    KindFacts{"restart", kNotRunning},
    KindFacts{"dns_silence", "its program asked for no other computer's name then"},
    KindFacts{"access_point_away", "no frame or packet was for the access point then"},
    KindFacts{"connection_reset", "no connection came so far in its window"},
    KindFacts{"sda", kNoByte},
    KindFacts{"scl", kNoByte},
    KindFacts{"parity", "frames without a parity bit are no candidates"},
    KindFacts{.name = "sag", .battery = true},
    KindFacts{.name = "battery", .battery = true},
};

KindFacts facts_of(const FaultSpec& fault) {
    const auto* found = std::find_if(kFacts.begin(), kFacts.end(),
                                     [&](const KindFacts& one) { return one.name == fault.kind; });
    return found == kFacts.end() ? KindFacts{} : *found;
}

}  // namespace

std::string_view why_silent(const FaultSpec& fault) {
    const std::string_view known = facts_of(fault).silent;
    if (!known.empty()) return known;
    const bool chosen = !fault.match.empty() || !fault.bytes.empty() || fault.position || fault.skip > 0;
    if (!fault.link.empty() && chosen)
        return "no frame in its window is one that match, bytes, position and skip choose";
    return {};
}

bool is_of_battery(const FaultSpec& fault) {
    return facts_of(fault).battery;
}

bool outlives_program(const FaultSpec& fault) {
    return fault.kind == "kill" && fault.parameters.text("run") == "goes_on";
}

}  // namespace puckloop::cosim
