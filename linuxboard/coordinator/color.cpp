#include "linuxboard/coordinator/color.h"

#include <charconv>
#include <fmt/format.h>

namespace puckloop::coordinator {

std::string to_text(Color color) {
    return fmt::format("{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

bool parse_color(std::string_view text, Color& color) {
    constexpr std::size_t kDigits = 6;
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (text.size() != kDigits || error != std::errc() || end != text.data() + text.size()) return false;
    color = {static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
             static_cast<std::uint8_t>(value)};
    return true;
}

}  // namespace puckloop::coordinator
