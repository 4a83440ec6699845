#include "tools/cli/check.h"

#include "tools/cli/shown_word.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace puckloop::tools {

namespace {

/// Empty, or what is wrong with `text`.
template <class Number>
std::string outside(const std::string& text, Number low, Number high) {
    Number value{};
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error == std::errc{} && end == last && value >= low && value <= high) return {};
    return fmt::format("'{}' is not a number from {} to {}", shown_word(text), low, high);
}

}  // namespace

Check number_between(double low, double high) {
    return {[low, high](const std::string& text) { return outside(text, low, high); },
            fmt::format("{} to {}", low, high)};
}

Check whole_number_between(int low, int high) {
    return {[low, high](const std::string& text) { return outside(text, low, high); },
            fmt::format("{} to {}", low, high)};
}

Check positive_number() {
    constexpr double kLeast = std::numeric_limits<double>::min();
    constexpr double kMost = std::numeric_limits<double>::max();
    return {[](const std::string& text) {
                return outside(text, kLeast, kMost).empty()
                           ? std::string()
                           : fmt::format("'{}' is not a number above 0", shown_word(text));
            },
            "above 0"};
}

Check count_up_to(std::uint64_t most) {
    return {[most](const std::string& text) { return outside(text, std::uint64_t{0}, most); },
            fmt::format("0 to {}", most)};
}

Check not_empty() {
    return {[](const std::string& text) { return text.empty() ? std::string("is empty") : std::string(); },
            ""};
}

Check one_of(const std::vector<std::string>& words) {
    std::string list = fmt::format("{}", fmt::join(words, ", "));
    return {[words, list](const std::string& text) {
                return std::find(words.begin(), words.end(), text) != words.end()
                           ? std::string()
                           : fmt::format("'{}' is not one of {}", shown_word(text), list);
            },
            fmt::format("{{{}}}", fmt::join(words, ","))};
}

}  // namespace puckloop::tools
