#include "emu/image/line_table.h"

#include "base/error.h"
#include "emu/image/coff.h"
#include "emu/image/elf_file.h"
#include "emu/image/image_file.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

namespace puckloop::image {

namespace {

std::string_view without_folder(std::string_view path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

/// The bytes of one section.
class DwarfSection {
  public:
    explicit DwarfSection(std::string_view bytes)
        : reader_(bytes, "debug information"), end_(reader_.size()) {}
    std::uint64_t at = 0;
    std::uint64_t end() const { return end_; }
    void end_at(std::uint64_t end) { end_ = std::min(end, reader_.size()); }

    std::uint8_t u8() { return reader_.u8(advance(1), "a byte"); }
    std::uint16_t u16() { return reader_.u16(advance(2), "a number"); }
    std::uint32_t u32() { return reader_.u32(advance(4), "a number"); }
    std::string_view text() {
        const std::string_view found = reader_.text(at, end_, "a name");
        at += found.size() + 1;
        return found;
    }
    std::uint32_t unsigned_leb() {
        std::uint32_t value = 0;
        for (int shift = 0;; shift += 7) {
            const std::uint8_t byte = u8();
            if (shift < 32) value |= static_cast<std::uint32_t>(byte & 0x7F) << shift;
            if (!(byte & 0x80)) return value;
        }
    }
    std::int32_t signed_leb() {
        std::uint32_t value = 0;
        for (int shift = 0;;) {
            const std::uint8_t byte = u8();
            if (shift < 32) value |= static_cast<std::uint32_t>(byte & 0x7F) << shift;
            shift += 7;
            if (byte & 0x80) continue;
            if (shift < 32 && (byte & 0x40)) value |= ~std::uint32_t{0} << shift;
            return static_cast<std::int32_t>(value);
        }
    }
    std::string_view name_at(std::uint64_t offset) const {
        return reader_.text(offset, reader_.size(), "a name");
    }

  private:
    std::uint64_t advance(std::uint64_t count) {
        const std::uint64_t here = at;
        if (end_ - at < count) reader_.fail(at, "ends in the middle", "more bytes");
        at += count;
        return here;
    }
    ByteReader reader_;
    std::uint64_t end_;
};

/// The dsPIC's assembler writes each byte of a debug section into a word of program memory, of whose upper
/// half nothing is left but a zero. No other section has a zero in every second place: the versions, lengths
/// and opcodes of DWARF stand there.
std::string without_padding(std::string_view bytes) {
    std::string kept;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        if (bytes[i + 1] != 0) return std::string(bytes);
        kept += bytes[i];
    }
    return kept;
}

/// Source: "The stabs debug format", sections "Line Numbers" and "Stab Section Basics".
void read_stabs(DwarfSection stabs, const DwarfSection& names, LineTable& lines) {
    enum : std::uint8_t { kUnit = 0x00, kFunction = 0x24, kLine = 0x44, kSource = 0x64, kIncluded = 0x84 };
    std::uint64_t strings = 0, next_strings = 0;
    std::uint32_t function = 0;
    std::string_view file;
    constexpr std::uint64_t kEntry = 12;
    while (stabs.end() - stabs.at >= kEntry) {
        const std::uint32_t name = stabs.u32();
        const std::uint8_t type = stabs.u8();
        stabs.u8();
        const std::uint16_t line = stabs.u16();
        const std::uint32_t value = stabs.u32();
        switch (type) {
        case kUnit:  // the header of one object file's entries
            strings = next_strings;
            next_strings += value;
            break;
        case kSource:
        case kIncluded:
            if (type == kSource) function = 0;
            if (const auto text = names.name_at(strings + name); !text.ends_with('/')) file = text;
            if (type == kSource && file.empty()) lines.add(value, "", 0);
            break;
        case kFunction:
            if (names.name_at(strings + name).empty()) {
                lines.add(function + value, "", 0);
                function = 0;
            } else {
                function = value;
            }
            break;
        case kLine:
            if (!file.empty()) lines.add(function + value, file, line);
            break;
        default:
            break;
        }
    }
}

/// One unit's program. Source: DWARF Debugging Information Format, version 2.0.0, section 6.2.
void run_line_program(DwarfSection& s, LineTable& lines) {
    const std::uint64_t start = s.at;
    const std::uint64_t end = start + 4 + s.u32();
    DwarfSection unit = s;
    unit.end_at(end);
    s.at = std::min(end, s.end());
    const std::uint16_t version = unit.u16();
    if (version < 2 || version > 4) return;
    const std::uint32_t header = unit.u32();
    const std::uint64_t program = unit.at + header;
    const std::uint8_t step = unit.u8();
    if (version == 4) unit.u8();
    unit.u8();  // whether rows begin statements
    const auto line_base = static_cast<std::int8_t>(unit.u8());
    const std::uint8_t line_range = unit.u8(), first_special = unit.u8();
    if (line_range == 0 || first_special == 0) return;
    std::array<std::uint8_t, 256> operands{};
    for (std::uint8_t i = 1; i < first_special; ++i)
        operands[i] = unit.u8();
    while (!unit.text().empty()) {
    }  // folders
    std::vector<std::string_view> files;
    while (true) {
        const std::string_view file = unit.text();
        if (file.empty()) break;
        files.push_back(file);
        for (int i = 0; i < 3; ++i)
            unit.unsigned_leb();
    }
    if (program < unit.at || program > unit.end()) return;
    unit.at = program;
    std::uint32_t address = 0, file = 1, line = 1;
    const auto row = [&] {
        if (file >= 1 && file <= files.size()) lines.add(address, files[file - 1], line);
    };
    enum : std::uint8_t {
        kExtended,
        kCopy,
        kAdvancePc,
        kAdvanceLine,
        kSetFile,
        kSetColumn,
        kNegate,
        kBlock,
        kConstPc,
        kFixedPc
    };
    enum : std::uint8_t { kEndSequence = 1, kSetAddress = 2 };
    while (unit.at < unit.end()) {
        const std::uint8_t opcode = unit.u8();
        if (opcode >= first_special) {
            const unsigned adjusted = opcode - first_special;
            address += adjusted / line_range * step;
            line += static_cast<std::uint32_t>(line_base + static_cast<int>(adjusted % line_range));
            row();
            continue;
        }
        switch (opcode) {
        case kExtended: {
            const std::uint32_t length = unit.unsigned_leb();
            const std::uint64_t after = unit.at + length;
            if (length == 0) break;
            const std::uint8_t what = unit.u8();
            if (what == kSetAddress && length == 5) address = unit.u32();
            if (what == kSetAddress && length == 3) address = unit.u16();
            if (what == kEndSequence) {
                lines.add(address, "", 0);
                address = 0, file = 1, line = 1;
            }
            if (after > unit.end()) return;
            unit.at = after;
            break;
        }
        case kCopy:
            row();
            break;
        case kAdvancePc:
            address += unit.unsigned_leb() * step;
            break;
        case kAdvanceLine:
            line += static_cast<std::uint32_t>(unit.signed_leb());
            break;
        case kSetFile:
            file = unit.unsigned_leb();
            break;
        case kConstPc:
            address += static_cast<std::uint32_t>((255 - first_special) / line_range) * step;
            break;
        case kFixedPc:
            address += unit.u16();
            break;
        default:
            for (std::uint8_t i = 0; i < operands[opcode]; ++i)
                unit.unsigned_leb();
            break;
        }
    }
}

}  // namespace

void LineTable::add(std::uint32_t address, std::string_view file, std::uint32_t line) {
    const std::string_view name = without_folder(file);
    auto place = std::find(files_.rbegin(), files_.rend(), name);
    if (place == files_.rend()) {
        if (files_.size() == std::numeric_limits<std::uint16_t>::max()) return;
        files_.emplace_back(name);
        place = files_.rbegin();
    }
    const Row row{static_cast<std::uint16_t>(std::distance(place, files_.rend()) - 1), line};
    // The end of a stretch is no reason to forget what begins there.
    if (line == 0)
        rows_.try_emplace(address, row);
    else
        rows_[address] = row;
}

std::string LineTable::at(std::uint32_t address) const {
    auto row = rows_.upper_bound(address);
    if (row == rows_.begin()) return {};
    --row;
    if (row->second.line == 0) return {};
    return files_[row->second.file] + ":" + std::to_string(row->second.line);
}

std::vector<std::uint32_t> LineTable::addresses(std::string_view file, std::uint32_t line) const {
    std::vector<std::uint32_t> found;
    const std::string_view name = without_folder(file);
    bool inside = false;
    for (const auto& [address, row] : rows_) {
        const bool here = row.line == line && files_[row.file] == name;
        if (here && !inside) found.push_back(address);
        inside = here;
    }
    return found;
}

std::vector<LineTable::Stretch> LineTable::stretches() const {
    std::vector<Stretch> all;
    for (const auto& [address, row] : rows_)
        if (row.line != 0) all.push_back({address, files_[row.file], row.line});
    return all;
}

LineTable source_lines(const std::string& path) {
    const std::string bytes = read_image_file(path);
    if (is_coff(bytes)) return read_coff_lines(bytes, path);
    if (!is_elf(bytes)) return {};
    return read_lines(ElfFile(bytes, path, elf_machine(bytes), "this chip's"));
}

LineTable read_lines(const ElfFile& elf) {
    LineTable lines;
    const std::vector<Elf32_Shdr> sections = elf.sections();
    const auto find = [&](std::string_view name) {
        return std::find_if(sections.begin(), sections.end(),
                            [&](const Elf32_Shdr& header) { return elf.section_name(header) == name; });
    };
    const auto stab = find(".stab"), names = find(".stabstr"), dwarf = find(".debug_line");
    try {
        if (stab != sections.end() && names != sections.end())
            read_stabs(DwarfSection(elf.data(*stab)), DwarfSection(elf.data(*names)), lines);
    } catch (const InputError&) {
    }
    try {
        if (dwarf != sections.end()) {
            const std::string bytes = without_padding(elf.data(*dwarf));
            for (DwarfSection all(bytes); all.at + 4 < all.end();)
                run_line_program(all, lines);
        }
    } catch (const InputError&) {
    }
    return lines;
}

}  // namespace puckloop::image
