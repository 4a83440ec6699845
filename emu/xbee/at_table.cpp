#include "emu/xbee/at_table.h"

#include <algorithm>
#include <array>

namespace puckloop::xbee {

namespace {

constexpr std::uint32_t kAny8 = 0xFF, kAny16 = 0xFFFF, kAny32 = 0xFFFFFFFF;

// clang-format off
constexpr std::array kTable{
    // In the order of `At`.
    AtParameter{"DH", 4, 0, kAny32, 0},
    AtParameter{"DL", 4, 0, kAny32, 0xFFFF},
    AtParameter{"NT", 2, 0x20, 0x2EE0, 0x82},      // 100 ms
    AtParameter{"NO", 1, 0, 7, 0},
    AtParameter{"CH", 1, 0x0B, 0x1A, 0x0C},
    AtParameter{"ID", 2, 0, 0x7FFF, 0x7FFF},
    AtParameter{"CA", 1, 0, 0x50, 0},              // -dBm; 0: off
    AtParameter{"PL", 1, 0, 4, 4},
    AtParameter{"RR", 1, 0, 0xF, 0xA},
    AtParameter{"MT", 1, 0, 0xF, 3},
    AtParameter{"NH", 1, 1, kAny8, 7},
    AtParameter{"NN", 1, 1, 5, 3},
    AtParameter{"MR", 1, 0, 7, 1},
    AtParameter{"BD", 4, 0, 250000, 3},
    AtParameter{"RO", 1, 0, kAny8, 3},             // character times
    AtParameter{"FT", 1, 0x11, 0xEE, 0xBE},        // bytes
    AtParameter{"AP", 1, 0, 2, 0},
    AtParameter{"D6", 1, 0, 5, 0},                 // 1: RTS
    AtParameter{"D7", 1, 0, 7, 1},                 // 1: CTS
    AtParameter{"SM", 1, 0, 8, 0},
    AtParameter{"CC", 1, 0, kAny8, 0x2B},
    AtParameter{"CT", 2, 2, 0x1770, 0x64},         // 100 ms
    AtParameter{"GT", 2, 1, 0x0CE4, 0x3E8},        // ms
    AtParameter{"SP", 2, 1, kAny16, 0xC8},         // 10 ms
    AtParameter{"ST", 2, 1, 0x36EE, 0x7D0},        // ms
    // Kept and given back; nothing in the model looks at them.
    AtParameter{"NP", 2, 0, 0, 73, true},
    AtParameter{"HV", 2, 0, 0, 0x1744, true},
    AtParameter{"VR", 2, 0, 0, 0x8073, true},
    AtParameter{"AO", 1, 0, 0, 0},                 // frames 90 only
    AtParameter{"BH", 1, 0, 0x20, 0},
    AtParameter{"CE", 1, 0, 2, 0},
    AtParameter{"CI", 2, 0, kAny16, 0x11},
    AtParameter{"DE", 1, 0, kAny8, 0xE8},
    AtParameter{"SE", 1, 0, kAny8, 0xE8},
    AtParameter{"DD", 4, 0, kAny32, 0x00010000},
    AtParameter{"NB", 1, 0, 0, 0},                 // parity: none only
    AtParameter{"EE", 1, 0, 0, 0},                 // encryption: off only
    AtParameter{"SO", 2, 0, kAny16, 2},
    AtParameter{"D0", 1, 0, 5, 1},
    AtParameter{"D1", 1, 0, 5, 0},
    AtParameter{"D2", 1, 0, 5, 0},
    AtParameter{"D3", 1, 0, 5, 0},
    AtParameter{"D4", 1, 0, 5, 0},
    AtParameter{"D5", 1, 0, 5, 1},
    AtParameter{"D8", 1, 0, 5, 1},
    AtParameter{"P0", 1, 0, 5, 1},
    AtParameter{"P1", 1, 0, 5, 0},
    AtParameter{"PR", 2, 0, 0x1FFF, 0x1FFF},
};
// clang-format on

static_assert(kTable[kDH].command == "DH" && kTable[kID].command == "ID" && kTable[kMR].command == "MR" &&
              kTable[kAP].command == "AP" && kTable[kSM].command == "SM" && kTable[kGT].command == "GT" &&
              kTable[kST].command == "ST");

}  // namespace

std::span<const AtParameter> at_table() {
    return kTable;
}

std::optional<std::size_t> find_parameter(std::string_view command) {
    const auto* found = std::find_if(kTable.begin(), kTable.end(),
                                     [&](const AtParameter& one) { return one.command == command; });
    if (found == kTable.end()) return std::nullopt;
    return static_cast<std::size_t>(found - kTable.begin());
}

bool accepts(const AtParameter& parameter, std::uint64_t value) {
    constexpr std::uint32_t kLastStandardRate = 7, kLeastRate = 0x80;
    if (parameter.command == "BD" && value > kLastStandardRate && value < kLeastRate) return false;
    return value >= parameter.least && value <= parameter.most;
}

}  // namespace puckloop::xbee
