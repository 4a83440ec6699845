#include "base/error.h"

#include <fmt/format.h>

namespace puckloop {

namespace {

std::string one_line(std::string_view file, std::string_view place, std::string_view problem,
                     std::string_view expected) {
    std::string text;
    if (!file.empty()) text += fmt::format("{}: ", file);
    if (!place.empty()) text += fmt::format("{}: ", place);
    text += problem;
    if (!expected.empty()) text += fmt::format(" (expected {})", expected);
    return text;
}

}  // namespace

InputError::InputError(std::string_view file, std::string_view place, std::string_view problem,
                       std::string_view expected)
    : std::runtime_error(one_line(file, place, problem, expected)), file_(file), place_(place) {}

}  // namespace puckloop
