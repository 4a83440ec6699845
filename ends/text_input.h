#pragma once
// Line-oriented input files of the bench: words on lines, # starts a comment, empty lines are skipped.

#include "cosim/core/time.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::exec {

/// One line that is not empty: its number in the file (from 1) and its words.
struct TextLine {
    int number = 0;
    std::vector<std::string_view> words;
};

/// The words view into `text`, which must outlive them.
std::vector<TextLine> split_lines(std::string_view text);

/// Whole file, at most 64 MB; throws InputError if it cannot be read.
std::string read_text_file(const std::string& path);

/// These throw InputError naming `file` and the line.
cosim::Time parse_time(std::string_view file, int line, std::string_view word);  ///< seconds, 0 to 1e6
double parse_number(std::string_view file, int line, std::string_view word, std::string_view what, double min,
                    double max);
/// Decimal, or hexadecimal after 0x; at most `max`.
std::uint32_t parse_integer(std::string_view file, int line, std::string_view word, std::string_view what,
                            std::uint32_t max);
/// Hexadecimal bytes from words[first] on, two digits each, with or without spaces; at least one.
std::vector<std::uint8_t> parse_hex_bytes(std::string_view file, const TextLine& line, std::size_t first);

}  // namespace puckloop::exec
