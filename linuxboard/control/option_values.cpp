#include "linuxboard/control/option_values.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace puckloop::control {

namespace {
constexpr double kLongest = 1e9;  // s
}

void wrong_value(const char* option, const char* text, const std::string& expected) {
    std::fprintf(stderr, "%s: --%s %s: expected %s\n", program_invocation_short_name, option, text,
                 expected.c_str());
    std::exit(kWrongUse);
}

double number(const char* option, const char* text, const std::string& expected, double low, double high) {
    char* end = nullptr;
    const double value = std::strtod(text, &end);
    if (end == text || *end != '\0' || !(value >= low) || !(value <= high))
        wrong_value(option, text, expected);
    return value;
}

double seconds(const char* option, const char* text, double least) {
    char expected[64];
    std::snprintf(expected, sizeof expected, least > 0 ? "at least %g seconds" : "a number of seconds",
                  least);
    return number(option, text, expected, least, kLongest);
}

int whole(const char* option, const char* text, int low, int high) {
    char* end = nullptr;
    const long value = std::strtol(text, &end, 10);
    if (end == text || *end != '\0' || value < low || value > high)
        wrong_value(option, text,
                    "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    return static_cast<int>(value);
}

int byte(const char* option, const char* text) {
    const bool hexadecimal = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    char* end = nullptr;
    const long value = std::strtol(text, &end, hexadecimal ? 16 : 10);
    if (end == text || *end != '\0' || value < 0 || value > 0xFF)
        wrong_value(option, text, "a byte, 0 to 255 or 0x00 to 0xff");
    return static_cast<int>(value);
}

}  // namespace puckloop::control
