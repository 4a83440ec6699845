// Source lines of C30's COFF. Layout as seen in a real image, checked against its functions: a function's
// symbol has an auxiliary entry with its size in program addresses and where its line numbers are in the
// file; these are 8 bytes each (address, line of the file, flags), the first of which names the function and
// has line 0. Files are named by .file symbols before the functions', the C file behind what it includes.

#include "base/error.h"
#include "emu/image/byte_reader.h"
#include "emu/image/coff.h"

namespace puckloop::image {

namespace {

constexpr std::uint64_t kLineSize = 8;
constexpr std::uint8_t kClassFile = 103;
constexpr std::uint16_t kFunctionType = 0x20, kDerivedType = 0x30;

class Reader {
  public:
    Reader(std::string_view bytes, const std::string& file)
        : reader_(bytes, file),
          symbols_(reader_.u32(8, "the file header")),
          count_(reader_.u32(12, "the file header")) {
        reader_.slice(symbols_, count_ * kCoffSymbolSize, "the symbol table");
    }

    void read(LineTable& lines) {
        std::string_view source;
        for (std::uint64_t i = 0; i < count_;) {
            const std::uint64_t at = symbols_ + i * kCoffSymbolSize;
            const std::uint16_t type = reader_.u16(at + 14, "a symbol");
            const std::uint8_t storage = reader_.u8(at + 16, "a symbol");
            const std::uint8_t auxiliaries = reader_.u8(at + 17, "a symbol");
            i += 1u + auxiliaries;
            if (auxiliaries == 0 || i > count_) continue;
            if (storage == kClassFile) {
                const std::string_view name = file_name(at + kCoffSymbolSize);
                if (!name.ends_with(".h")) source = name;
            } else if ((storage == kClassExternal || storage == kClassStatic) &&
                       (type & kDerivedType) == kFunctionType) {
                read_function(at, source, lines);
            }
        }
    }

  private:
    std::string_view file_name(std::uint64_t at) const {
        std::string_view name;
        if (reader_.u32(at, "a file's name") != 0) {
            name = reader_.slice(at, 14, "a file's name");
            name = name.substr(0, name.find('\0'));
        } else {
            const std::uint64_t strings = symbols_ + count_ * kCoffSymbolSize;
            name =
                reader_.text(strings + reader_.u32(at + 4, "a file's name"), reader_.size(), "a file's name");
        }
        return name.substr(name.find_last_of("\\/") + 1);
    }

    void read_function(std::uint64_t at, std::string_view source, LineTable& lines) const {
        const std::uint32_t begin = reader_.u32(at + 8, "a function");
        const std::uint32_t size = reader_.u32(at + kCoffSymbolSize + 4, "a function");
        const std::uint64_t first = reader_.u32(at + kCoffSymbolSize + 8, "a function");
        if (size == 0 || first == 0 || source.empty()) return;
        lines.add(begin + size, "", 0);
        for (std::uint64_t entry = first + kLineSize;; entry += kLineSize) {
            if (entry + kLineSize > reader_.size()) return;
            const std::uint32_t address = reader_.u32(entry, "a line");
            const std::uint16_t line = reader_.u16(entry + 4, "a line");
            if (line == 0 || address < begin || address - begin >= size) return;
            // What is before the first line is the function's prologue.
            lines.add(entry == first + kLineSize ? begin : address, source, line);
        }
    }

    ByteReader reader_;
    std::uint64_t symbols_, count_;
};

}  // namespace

LineTable read_coff_lines(std::string_view bytes, const std::string& file) {
    LineTable lines;
    try {
        Reader(bytes, file).read(lines);
    } catch (const InputError&) {
    }
    return lines;
}

}  // namespace puckloop::image
