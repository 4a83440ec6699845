#include "base/error.h"
#include "tools/records/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iostream>

namespace puckloop::tools {

namespace {

constexpr std::size_t kQuotedCharacters = 40;
constexpr char kWhiteSpace[] = " \t\r";

std::string trimmed(const std::string& line) {
    const std::size_t first = line.find_first_not_of(kWhiteSpace);
    if (first == std::string::npos) return {};
    return line.substr(first, line.find_last_not_of(kWhiteSpace) - first + 1);
}

}  // namespace

void for_each_input(const std::vector<std::string>& arguments,
                    const std::function<void(const std::string&, const std::string&)>& take) {
    for (const std::string& argument : arguments)
        take(trimmed(argument), "");
    if (!arguments.empty()) return;
    std::int64_t number = 0;
    for (std::string line; std::getline(std::cin, line);)
        take(trimmed(line), fmt::format("standard input, line {}", ++number));
    if (number == 0)
        throw InputError("standard input", "", "holds no line", "one frame per line, or an argument");
}

std::int64_t parse_number(std::string_view text, int base, std::int64_t low, std::int64_t high,
                          std::string_view origin, std::string_view what) {
    const auto bounds = [&] {
        return base == 16 ? fmt::format("{:X} to {:X}, hexadecimal", low, high)
                          : fmt::format("{} to {}", low, high);
    };
    std::string_view digits = text;
    if (base == 16 && (digits.starts_with("0x") || digits.starts_with("0X"))) digits.remove_prefix(2);
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
    if (error == std::errc::invalid_argument || stop != digits.data() + digits.size())
        throw InputError(origin, what, fmt::format("{} is no number", shown(text)), bounds());
    if (error != std::errc{} || value < low || value > high)
        throw InputError(
            origin, what,
            fmt::format("{} is too {}", shown(text), value < low && error == std::errc{} ? "small" : "large"),
            bounds());
    return value;
}

std::vector<std::uint8_t> bytes_of(const std::string& text, const std::string& origin) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t at = 0; at < text.size();) {
        if (text[at] == ' ' || text[at] == '\t') {
            ++at;
            continue;
        }
        const std::string pair = text.substr(at, 2);
        if (!std::all_of(pair.begin(), pair.end(), [](unsigned char c) { return std::isxdigit(c) != 0; }) ||
            pair.size() != 2)
            throw InputError(origin, fmt::format("byte {}", bytes.size()),
                             fmt::format("{} is no byte", shown(pair)), "two hexadecimal digits");
        bytes.push_back(static_cast<std::uint8_t>(std::stoul(pair, nullptr, 16)));
        at += 2;
    }
    return bytes;
}

std::string shown(std::string_view text) {
    std::string line = "\"";
    for (const char c : text.substr(0, kQuotedCharacters)) {
        const auto byte = static_cast<unsigned char>(c);
        line += byte < ' ' || byte >= 0x7F ? '?' : c;
    }
    return line + (text.size() > kQuotedCharacters ? "...\"" : "\"");
}

}  // namespace puckloop::tools
