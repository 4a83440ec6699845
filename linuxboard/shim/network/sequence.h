#pragma once
// TCP's sequence numbers, which wrap (RFC 9293, 3.4).

#include <cstdint>

namespace puckloop::linuxboard {

constexpr bool before(std::uint32_t a, std::uint32_t b) {
    return static_cast<std::int32_t>(a - b) < 0;
}
constexpr bool after(std::uint32_t a, std::uint32_t b) {
    return before(b, a);
}

}  // namespace puckloop::linuxboard
