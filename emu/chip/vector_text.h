#pragma once
// What the single-instruction vectors of all chips have in common: "<id> key=value ..." lines with
// hexadecimal numbers and lists.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::chip {

/// What is wrong with a line; becomes its `error` answer.
struct Malformed {
    std::string what;
};

/// Throws Malformed naming `key`.
std::uint64_t parse_number(std::string_view key, std::string_view text, std::uint64_t highest, int base = 16);

std::vector<std::string_view> split(std::string_view text, char separator);

/// Exactly `count` numbers separated by commas.
std::vector<std::uint16_t> parse_numbers(std::string_view key, std::string_view text, std::size_t count,
                                         std::uint16_t highest = 0xFFFF);

/// One place of memory.
struct Cell {
    std::uint32_t address = 0;
    std::uint32_t word = 0;
};
/// "address:word,address:word"; the empty text is no cell.
std::vector<Cell> parse_cells(std::string_view key, std::string_view text, std::uint32_t highest_word,
                              bool even_addresses = true);

/// Calls `take(key, value)` for every key=value of the text; a key given twice is malformed.
template <class Take>
void for_each_key(std::string_view text, Take take) {
    std::vector<std::string_view> seen;
    for (const auto token : split(text, ' ')) {
        if (token.empty()) continue;
        const auto equals = token.find('=');
        if (equals == std::string_view::npos)
            throw Malformed{"'" + std::string(token) + "' is not key=value"};
        const auto key = token.substr(0, equals);
        for (const auto other : seen)
            if (other == key) throw Malformed{std::string(key) + " given twice"};
        seen.push_back(key);
        take(key, token.substr(equals + 1));
    }
}

/// Appends `digits` hexadecimal digits.
void put_hex(std::string& out, std::uint64_t value, int digits);

/// The first word of a line, "-" if it is empty, and what follows it.
struct Line {
    std::string id;
    std::string_view rest;
    bool has_rest = false;
};
Line split_line(std::string_view line);

}  // namespace puckloop::chip
