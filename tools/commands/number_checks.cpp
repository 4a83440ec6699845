#include "tools/commands/number_checks.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>

namespace puckloop::tools {

namespace {

/// Empty, or what is wrong with `text`.
template <class Number>
std::string outside(const std::string& text, Number low, Number high) {
    Number value{};
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error == std::errc{} && end == last && value >= low && value <= high) return {};
    return fmt::format("'{}' is not a number from {} to {}", text, low, high);
}

}  // namespace

CLI::Validator number_between(double low, double high) {
    return {[low, high](std::string& text) { return outside(text, low, high); },
            fmt::format("{} to {}", low, high)};
}

CLI::Validator positive_number() {
    constexpr double kLeast = std::numeric_limits<double>::min();
    constexpr double kMost = std::numeric_limits<double>::max();
    return {[](std::string& text) {
                return outside(text, kLeast, kMost).empty()
                           ? std::string()
                           : fmt::format("'{}' is not a number above 0", text);
            },
            "above 0"};
}

CLI::Validator count_up_to(std::uint64_t most) {
    return {[most](std::string& text) { return outside(text, std::uint64_t{0}, most); },
            fmt::format("0 to {}", most)};
}

CLI::Validator not_empty() {
    return {[](std::string& text) { return text.empty() ? std::string("is empty") : std::string(); }, ""};
}

}  // namespace puckloop::tools
