#include "base/error.h"

#include <fmt/format.h>

namespace puckloop {

namespace {

/// What a user gave may hold anything: control characters would break the line or steer his terminal.
std::string without_controls(std::string_view text) {
    std::string plain;
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x20 || code == 0x7F)
            plain += fmt::format("\\x{:02x}", code);
        else
            plain += c;
    }
    return plain;
}

std::string one_line(std::string_view file, std::string_view place, std::string_view problem,
                     std::string_view expected) {
    std::string text;
    if (!file.empty()) text += fmt::format("{}: ", file);
    if (!place.empty()) text += fmt::format("{}: ", place);
    text += problem;
    if (!expected.empty()) text += fmt::format(" (expected {})", expected);
    return without_controls(text);
}

}  // namespace

InputError::InputError(std::string_view file, std::string_view place, std::string_view problem,
                       std::string_view expected)
    : std::runtime_error(one_line(file, place, problem, expected)), file_(file), place_(place) {}

}  // namespace puckloop
