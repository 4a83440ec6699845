#pragma once
// Which source line a program address belongs to, as a compiler noted it in an ELF file.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::image {

class LineTable {
  public:
    /// From `address` on the code is of this line; line 0: of none.
    void add(std::uint32_t address, std::string_view file, std::uint32_t line);

    bool empty() const { return rows_.empty(); }
    /// "main.c:12", the file without its folder; empty if nothing is known.
    std::string at(std::uint32_t address) const;
    /// Lowest address of each stretch of code of this line, rising; `file` with or without its folder.
    std::vector<std::uint32_t> addresses(std::string_view file, std::uint32_t line) const;
    /// Code of one line, up to where the next stretch begins.
    struct Stretch {
        std::uint32_t address = 0;
        std::string_view file;  ///< without its folder; of this table
        std::uint32_t line = 0;
    };
    /// By address; what belongs to no line is left out.
    std::vector<Stretch> stretches() const;

  private:
    struct Row {
        std::uint16_t file = 0;
        std::uint32_t line = 0;
    };
    std::map<std::uint32_t, Row> rows_;
    std::vector<std::string> files_;
};

class ElfFile;
/// What the sections .stab (gcc's default for the AVR) and .debug_line (DWARF 2 to 4; XC16's with a zero
/// behind each byte) hold; addresses as the compiler counts them, on the dsPIC two a word. Debug information
/// is of no use to the chip: where it is damaged reading ends, and what was read so far stays.
LineTable read_lines(const ElfFile& elf);
/// The same of a file; empty for other formats. Throws InputError for a file that cannot be read or is
/// damaged.
LineTable source_lines(const std::string& path);

}  // namespace puckloop::image
