#pragma once
// `type`: bytes that somebody types into a UART line (cosim/faults/uart/uart_typed.cpp).

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

inline constexpr std::string_view kTypedKind = "type";
/// Of one fault of this kind, over all its instants.
inline constexpr std::size_t kMostTyped = 100'000;

/// "64 2c0d": pairs of hexadecimal digits, blanks between them or not. Empty: no such text, or none at all.
std::vector<std::uint8_t> typed_bytes(std::string_view hexadecimal);

}  // namespace puckloop::cosim
