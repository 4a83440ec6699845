#pragma once
// The AT parameters of an XB24-DM module (XBee Series 1 hardware, DigiMesh 2.4 firmware 8073): size, range
// and factory value, one line each. Source: XBee/XBee-PRO DigiMesh 2.4 manual (90000991 W), "AT commands". HV
// and VR are those of modules of this kind, not of the manual.

#include "protocols/xbee_message.h"

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
    kSM
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

}  // namespace puckloop::xbee
