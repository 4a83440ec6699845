#include "emu/image/coff.h"

#include "emu/image/byte_reader.h"
#include "emu/image/dspic_view.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::image {

namespace {

constexpr std::uint16_t kMagic30 = 0x1236;
constexpr std::uint64_t kFileHeaderSize = 20;
constexpr std::uint64_t kSectionHeaderSize = 40;
constexpr std::uint64_t kRelocationSize = 10;
constexpr std::uint16_t kFlagExecutable = 0x0002;
constexpr std::uint32_t kSectionText = 0x0020;
constexpr std::uint8_t kClassLabel = 6;
constexpr std::int16_t kSectionAbsolute = -1;

struct Section {
    std::string name;
    std::uint32_t physical = 0;
    std::uint32_t virtual_address = 0;
    std::uint32_t size = 0;
    std::uint32_t offset = 0;
    std::uint32_t flags = 0;

    bool is_program() const {
        return size > 0 && offset > 0 && ((flags & kSectionText) != 0 || physical >= kEepromStart);
    }
    Space symbol_space() const {
        return (flags & kSectionText) != 0 && physical == virtual_address ? Space::Program : Space::Data;
    }
};

class CoffReader {
  public:
    CoffReader(std::string_view bytes, Image& image) : reader_(bytes, image.file), image_(image) {}

    void read() {
        const std::uint16_t section_count = reader_.u16(2, "the file header");
        const std::uint32_t symbol_table = reader_.u32(8, "the file header");
        const std::uint32_t symbol_count = reader_.u32(12, "the file header");
        const std::uint16_t optional_size = reader_.u16(16, "the file header");
        const std::uint16_t flags = reader_.u16(18, "the file header");
        if ((flags & kFlagExecutable) == 0)
            reader_.fail(18, fmt::format("flags 0x{:04X} say an object file", flags),
                         "a linked, executable image");
        symbol_table_ = symbol_table;
        reader_.slice(symbol_table, symbol_count * kCoffSymbolSize, "the symbol table");
        string_table_ = symbol_table + symbol_count * kCoffSymbolSize;
        string_end_ = string_table_;
        if (symbol_count > 0 && string_table_ + 4 <= reader_.size()) {
            const std::uint32_t length = reader_.u32(string_table_, "the string table");
            reader_.slice(string_table_, length, "the string table");
            string_end_ = string_table_ + length;
        }
        read_sections(kFileHeaderSize + optional_size, section_count);
        read_symbols(symbol_count);
    }

  private:
    std::string_view fixed_name(std::uint64_t offset) const {
        const std::string_view name = reader_.slice(offset, 8, "a name");
        return name.substr(0, name.find('\0'));
    }

    std::string section_name(std::uint64_t offset) const {
        const std::string_view name = fixed_name(offset);
        if (name.size() < 2 || name[0] != '/') return std::string(name);
        std::uint32_t index = 0;
        const auto parsed = std::from_chars(name.data() + 1, name.data() + name.size(), index);
        if (parsed.ec != std::errc{} || parsed.ptr != name.data() + name.size())
            reader_.fail(offset, "a section name that is no string table offset", "'/' and a decimal number");
        return std::string(reader_.text(string_table_ + index, string_end_, "a section name"));
    }

    void read_sections(std::uint64_t table, std::uint16_t count) {
        reader_.slice(table, count * kSectionHeaderSize, "the section table");
        ByteSegments segments(image_.file);
        for (std::uint16_t i = 0; i < count; ++i) {
            const std::uint64_t at = table + i * kSectionHeaderSize;
            Section section;
            section.name = section_name(at);
            section.physical = reader_.u32(at + 8, "a section header");
            section.virtual_address = reader_.u32(at + 12, "a section header");
            section.size = reader_.u32(at + 16, "a section header");
            section.offset = reader_.u32(at + 20, "a section header");
            const std::uint16_t relocations = reader_.u16(at + 32, "a section header");
            section.flags = reader_.u32(at + 36, "a section header");
            if (relocations > 0)
                reader_.fail(at + 32,
                             fmt::format("section {} still has {} relocations of {} bytes", section.name,
                                         relocations, kRelocationSize),
                             "a linked, executable image");
            if (section.is_program()) {
                const std::string_view data =
                    reader_.slice(section.offset, section.size, "section " + section.name);
                segments.add(std::uint64_t{section.physical} * 2, {data.begin(), data.end()},
                             "section " + section.name);
            }
            sections_.push_back(std::move(section));
        }
        add_words(image_, segments.joined());
    }

    void read_symbols(std::uint32_t count) {
        for (std::uint32_t i = 0; i < count;) {
            const std::uint64_t at = symbol_table_ + i * kCoffSymbolSize;
            const std::uint32_t value = reader_.u32(at + 8, "a symbol");
            const auto section = static_cast<std::int16_t>(reader_.u16(at + 12, "a symbol"));
            const std::uint8_t storage = reader_.u8(at + 16, "a symbol");
            const std::uint8_t auxiliaries = reader_.u8(at + 17, "a symbol");
            i += 1u + auxiliaries;
            if (storage != kClassExternal && storage != kClassStatic && storage != kClassLabel) continue;
            if (section == 0 || section < kSectionAbsolute) continue;
            if (section > static_cast<int>(sections_.size()))
                reader_.fail(at + 12, fmt::format("a symbol of section {}", section),
                             fmt::format("1 to {}", sections_.size()));
            const std::string name = symbol_name(at);
            if (section == kSectionAbsolute && image_.chip.empty()) image_.chip = chip_from_symbol(name);
            if (name.empty() || name[0] == '.') continue;  // sections and the compiler's local labels
            const Space space = section == kSectionAbsolute
                                    ? Space::Absolute
                                    : sections_[static_cast<std::size_t>(section - 1)].symbol_space();
            const Symbol symbol{value, space, storage == kClassExternal};
            const auto [found, fresh] = image_.symbols.emplace(name, symbol);
            if (!fresh && symbol.global && !found->second.global) found->second = symbol;
        }
    }

    std::string symbol_name(std::uint64_t at) const {
        if (reader_.u32(at, "a symbol") != 0) return std::string(fixed_name(at));
        return std::string(
            reader_.text(string_table_ + reader_.u32(at + 4, "a symbol"), string_end_, "a symbol's name"));
    }

    ByteReader reader_;
    Image& image_;
    std::uint64_t symbol_table_ = 0;
    std::uint64_t string_table_ = 0;
    std::uint64_t string_end_ = 0;
    std::vector<Section> sections_;
};

}  // namespace

bool is_coff(std::string_view bytes) {
    return bytes.size() >= 2 && static_cast<std::uint8_t>(bytes[0]) == (kMagic30 & 0xFF) &&
           static_cast<std::uint8_t>(bytes[1]) == (kMagic30 >> 8);
}

void read_coff(std::string_view bytes, Image& image) {
    CoffReader(bytes, image).read();
}

}  // namespace puckloop::image
