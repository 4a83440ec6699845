#pragma once
// A dsPIC firmware image, whatever the file format it came in: Intel HEX in Microchip's address convention,
// ELF32 of XC16, COFF of C30. The format is recognised by content, never by the file's name.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::image {

enum class Format { IntelHex, Elf, Coff };
const char* name_of(Format format);

/// Where a symbol's address counts: program addresses (two a word), data addresses, or a plain number.
enum class Space { Program, Data, Absolute };

struct Symbol {
    std::uint32_t address = 0;
    Space space = Space::Program;
    bool global = false;
};

/// 24-bit words by even program address.
using Words = std::map<std::uint32_t, std::uint32_t>;

struct Image {
    std::string file;
    Format format = Format::IntelHex;
    std::string sha256;                     ///< of the file's bytes, lower-case hexadecimal
    std::string chip;                       ///< as the compiler noted it ("dspic30f6014a"), or empty
    Words program;                          ///< below 0x7FF000
    Words eeprom;                           ///< 0x7FF000..0x7FFFFE, 16 bits each
    Words config;                           ///< 0xF80000..0xF8FFFE, 16 bits each
    Words other;                            ///< executive memory, unit and device identification
    std::map<std::string, Symbol> symbols;  ///< of ELF and COFF; a global one wins over a local one

    /// Program address of `name`, or of `_name` (C functions carry an underscore).
    std::optional<std::uint32_t> find_code(std::string_view name) const;
    /// All four maps in one.
    Words all_words() const;
};

/// Reads and recognises a file. Throws InputError: missing, a directory, larger than 64 MB, damaged, unknown
/// format.
Image load_image(const std::string& path);

/// The same for bytes already in memory; `file` is the name for messages.
Image parse_image(std::string_view bytes, const std::string& file);

}  // namespace puckloop::image
