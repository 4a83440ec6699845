#include "ends/text_input.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace puckloop::exec {

namespace {

constexpr std::uintmax_t kLargestFile = 64u << 20;
constexpr double kLatest = 1e6;  // seconds

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

std::string place(int line) {
    return fmt::format("line {}", line);
}

/// A word of the input, fit to be shown: short, no control characters.
std::string shown(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, 40))
        text += c >= ' ' && c <= '~' ? c : '?';
    return word.size() > 40 ? text + "..." : text;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

}  // namespace

std::vector<TextLine> split_lines(std::string_view text) {
    std::vector<TextLine> lines;
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t newline = text.find('\n', begin);
        std::string_view line = text.substr(begin, newline == text.npos ? text.npos : newline - begin);
        begin = newline == text.npos ? text.size() : newline + 1;
        ++number;
        line = line.substr(0, line.find('#'));
        TextLine out{number, {}};
        for (std::size_t i = 0; i < line.size();) {
            if (is_space(line[i])) {
                ++i;
                continue;
            }
            std::size_t end = i;
            while (end < line.size() && !is_space(line[end]))
                ++end;
            out.words.push_back(line.substr(i, end - i));
            i = end;
        }
        if (!out.words.empty()) lines.push_back(std::move(out));
    }
    return lines;
}

std::string read_text_file(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) throw InputError(path, "", "no such file");
    if (std::filesystem::is_directory(status)) throw InputError(path, "", "is a directory", "a file");
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) > kLargestFile)
        throw InputError(path, "", "too large", "at most 64 MB");
    std::ifstream in(path, std::ios::binary);
    std::string text;
    char block[1 << 16];
    while (in && text.size() <= kLargestFile) {
        in.read(block, sizeof block);
        text.append(block, static_cast<std::size_t>(in.gcount()));
    }
    if (!in.eof()) throw InputError(path, "", fmt::format("cannot be read: {}", std::strerror(errno)));
    return text;
}

double parse_number(std::string_view file, int line, std::string_view word, std::string_view what, double min,
                    double max) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
        throw InputError(file, place(line), fmt::format("'{}' is not a {}", shown(word), what), "a number");
    if (value < min || value > max)
        throw InputError(file, place(line), fmt::format("{} {} is out of range", what, shown(word)),
                         fmt::format("{} to {}", min, max));
    return value;
}

cosim::Time parse_time(std::string_view file, int line, std::string_view word) {
    return cosim::from_seconds(parse_number(file, line, word, "time in seconds", 0, kLatest));
}

std::uint32_t parse_integer(std::string_view file, int line, std::string_view word, std::string_view what,
                            std::uint32_t max) {
    std::string_view digits = word;
    int base = 10;
    if (digits.size() > 2 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')) {
        digits.remove_prefix(2);
        base = 16;
    }
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
    const bool whole = end == digits.data() + digits.size();
    if (!whole || error == std::errc::invalid_argument)
        throw InputError(file, place(line), fmt::format("'{}' is not a {}", shown(word), what),
                         "a number, hexadecimal after 0x");
    if (error != std::errc{} || value > max)
        throw InputError(file, place(line), fmt::format("{} {} is out of range", what, shown(word)),
                         fmt::format("0 to {0} (0x{0:x})", max));
    return value;
}

std::vector<std::uint8_t> parse_hex_bytes(std::string_view file, const TextLine& line, std::size_t first) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = first; i < line.words.size(); ++i) {
        const std::string_view word = line.words[i];
        bool good = word.size() % 2 == 0;
        for (std::size_t k = 0; good && k < word.size(); k += 2) {
            const int high = hex_digit(word[k]), low = hex_digit(word[k + 1]);
            good = high >= 0 && low >= 0;
            if (good) bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
        }
        if (!good)
            throw InputError(file, place(line.number),
                             fmt::format("'{}' is not hexadecimal bytes", shown(word)),
                             "two digits a byte, such as 01 f4");
    }
    if (bytes.empty())
        throw InputError(file, place(line.number), "no bytes", "hexadecimal bytes, such as 01 f4");
    return bytes;
}

}  // namespace puckloop::exec
