#pragma once
// The colour of a TAM's three RGB LEDs, as SET_LEDS carries it.

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::coordinator {

/// 0 to 255 each; above 25 (0x19) the LEDs are unpleasant to look at.
struct Color {
    std::uint8_t red = 0, green = 0, blue = 0;
    bool operator==(const Color&) const = default;
};

inline constexpr Color kOff{};

/// "rrggbb", six hexadecimal digits.
std::string to_text(Color color);
/// The inverse; false if `text` is none.
bool parse_color(std::string_view text, Color& color);

}  // namespace puckloop::coordinator
