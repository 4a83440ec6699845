#pragma once
// The AT parameters of an XB24-DM module (XBee Series 1 hardware, DigiMesh 2.4): size, range and factory
// value, one line each. They follow the tables of the XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "AT
// commands"; none was read out of a module, and firmware versions differ in single ranges and factory values.
// The sizes of answers, HV and VR are what modules of this kind were seen to answer (TAM fact sheet, section
// 9), or assumptions.

#include "protocols/radio/xbee_message.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace puckloop::xbee {

struct AtParameter {
    std::string_view command;
    int octets;  ///< of an answer
    std::uint32_t least, most, factory;
    bool read_only = false;
};

// What the model itself looks at, by place in the table.
enum At : std::size_t {
    kDH,
    kDL,
    kNT,
    kNO,
    kCH,
    kID,
    kCA,
    kPL,
    kRR,
    kMT,
    kNH,
    kNN,
    kMR,
    kBD,
    kRO,
    kFT,
    kAP,
    kD6,
    kD7,
    kSM,
    kCC,
    kCT,
    kGT,
    kSP,
    kST
};

/// The places above first.
std::span<const AtParameter> at_table();
/// Place in the table, or nothing.
std::optional<std::size_t> find_parameter(std::string_view command);

/// AT status codes.
inline constexpr std::uint8_t kAtOk = 0, kAtError = 1, kAtUnknown = 2, kAtBadValue = 3, kAtNoAnswer = 4;
/// Set in the status of answers that came from another module: TAM fact sheet, section 6.
inline constexpr std::uint8_t kAtFromAir = 0x40;

inline constexpr std::size_t kMostNodeIdentifier = 20;

/// May the parameter have this value? BD has a gap between the eight standard rates and rates in bit/s.
bool accepts(const AtParameter& parameter, std::uint64_t value);

}  // namespace puckloop::xbee
