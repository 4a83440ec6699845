#include "emu/chip/vector_text.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::chip {

std::uint64_t parse_number(std::string_view key, std::string_view text, std::uint64_t highest, int base) {
    std::uint64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (text.empty() || failure != std::errc{} || end != text.data() + text.size())
        throw Malformed{
            fmt::format("{}: '{}' is not a {} number", key, text, base == 16 ? "hex" : "decimal")};
    if (value > highest) throw Malformed{fmt::format("{}: {} is more than {:x}", key, text, highest)};
    return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> pieces;
    while (true) {
        const auto at = text.find(separator);
        pieces.push_back(text.substr(0, at));
        if (at == std::string_view::npos) return pieces;
        text.remove_prefix(at + 1);
    }
}

std::vector<std::uint16_t> parse_numbers(std::string_view key, std::string_view text, std::size_t count,
                                         std::uint16_t highest) {
    std::vector<std::uint16_t> numbers;
    for (const auto piece : split(text, ','))
        numbers.push_back(static_cast<std::uint16_t>(parse_number(key, piece, highest)));
    if (numbers.size() != count)
        throw Malformed{fmt::format("{}: {} values, expected {}", key, numbers.size(), count)};
    return numbers;
}

std::vector<Cell> parse_cells(std::string_view key, std::string_view text, std::uint32_t highest_word,
                              bool even_addresses) {
    std::vector<Cell> cells;
    if (text.empty()) return cells;
    for (const auto piece : split(text, ',')) {
        const auto colon = piece.find(':');
        if (colon == std::string_view::npos)
            throw Malformed{fmt::format("{}: '{}' is not address:word", key, piece)};
        Cell cell;
        cell.address = static_cast<std::uint32_t>(parse_number(key, piece.substr(0, colon), 0xFFFFFF));
        cell.word = static_cast<std::uint32_t>(parse_number(key, piece.substr(colon + 1), highest_word));
        if (even_addresses && cell.address & 1)
            throw Malformed{fmt::format("{}: odd address {:x}", key, cell.address)};
        cells.push_back(cell);
    }
    return cells;
}

void put_hex(std::string& out, std::uint64_t value, int digits) {
    for (int i = digits - 1; i >= 0; --i)
        out += "0123456789abcdef"[value >> (4 * i) & 15];
}

Line split_line(std::string_view line) {
    while (!line.empty() && (line.back() == '\r' || line.back() == '\n' || line.back() == ' '))
        line.remove_suffix(1);
    const auto space = line.find(' ');
    Line parts;
    parts.id = line.substr(0, space);
    if (parts.id.empty()) parts.id = "-";
    parts.has_rest = space != std::string_view::npos;
    if (parts.has_rest) parts.rest = line.substr(space + 1);
    return parts;
}

}  // namespace puckloop::chip
