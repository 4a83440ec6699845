#pragma once
// The infra-red frame of the e-RandB range-and-bearing board, chip by chip. Source: range-and-bearing fact
// sheet, section 3. Written from the format alone, so that this and the firmware check each other.
//
//   6 chips on          preamble, not Manchester
//   2 chips a bit       payload of 8, 16, 24 or 32 bits, least significant bit first
//   2 chips a bit       check of 4 bits, most significant bit first: ones(payload) + check = 0 mod 16
//
// A bit is "10" if set and "01" if clear; 1 = carrier on. A chip lasts 98.085 us. Nothing marks the end, and
// the size is not sent: both boards are set to it.
//
// Deviations from a receiver on the air:
// 1. A frame begins with the text's first chip and ends with its last; on the air it begins with the first
//    chip that is on, and the silence after it reads as further chips that are off.
// 2. The firmware goes on after a bad check and takes later bits for it, so it accepts some longer frames as
//    their low bits; here every frame of another length is refused.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::protocols {

inline constexpr int kRabPreambleChips = 6;
inline constexpr int kRabCheckBits = 4;
inline constexpr std::array kRabSizes{8, 16, 24, 32};  ///< payload bits
inline constexpr char kRabSizesText[] = "8, 16, 24 or 32";

constexpr bool is_rab_size(int size) {
    for (const int one : kRabSizes)
        if (one == size) return true;
    return false;
}

/// Chips of a whole frame: 30, 46, 62 or 78.
constexpr int rab_frame_chips(int size) {
    return kRabPreambleChips + 2 * (size + kRabCheckBits);
}

/// The check of a payload: 0..15.
int rab_check(std::uint32_t payload);

/// A frame as '0' and '1', first chip first. Throws InputError: no such size, payload wider than the size.
std::string encode_rab(int size, std::uint32_t payload);

/// What the receiver of a frame can object to, in the order in which it looks.
enum class RabFault {
    None,
    Preamble,    ///< one of the first six chips is off
    Manchester,  ///< both chips of a bit are equal
    Length,      ///< too few or too many chips
    Check,       ///< well formed, and the check is another than the payload's
};

/// "none", "preamble", "manchester", "length", "check".
std::string_view name_of(RabFault fault);

/// What one frame holds, or what is wrong with it.
struct RabFrameReading {
    RabFault fault = RabFault::None;
    int chip = 0;               ///< with a fault: the first chip of the wrong part, counted from 0
    int size = 0;               ///< payload bits as asked for, or by the length; 0: no frame has this length
    int chips = 0;              ///< length of the text
    std::uint32_t payload = 0;  ///< without fault, and with Check
    int check = 0;              ///< as received; without fault, and with Check
    bool ok() const { return fault == RabFault::None; }
};

/// Reads one frame; `size` 0 goes by the length. Throws InputError, naming `origin` and the chip: nothing to
/// read, a character other than 0 and 1, no such size.
RabFrameReading decode_rab(std::string_view chips, int size = 0, std::string_view origin = {});

/// The fault in words with its chips, e.g. "manchester: chips 12 and 13 are equal"; "ok" without one.
std::string explain(const RabFrameReading& reading);

}  // namespace puckloop::protocols
