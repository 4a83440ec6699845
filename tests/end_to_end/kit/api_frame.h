#pragma once
// What an XBee module's line carries, for scripts at its serial port.

#include <fmt/format.h>

#include <string>
#include <vector>

namespace puckloop::tests {

/// A frame on the line in API mode 2, as hex.
inline std::string api_frame(const std::vector<int>& data) {
    std::vector<int> body{static_cast<int>(data.size() >> 8), static_cast<int>(data.size() & 0xFF)};
    int sum = 0;
    for (const int byte : data) {
        body.push_back(byte);
        sum += byte;
    }
    body.push_back(0xFF - (sum & 0xFF));
    std::string text = "7e";
    for (const int byte : body) {
        const bool special = byte == 0x7E || byte == 0x7D || byte == 0x11 || byte == 0x13;
        text += special ? fmt::format(" 7d {:02x}", byte ^ 0x20) : fmt::format(" {:02x}", byte);
    }
    return text;
}

}  // namespace puckloop::tests
