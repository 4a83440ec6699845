#include "emu/image/avr_image.h"

#include "base/error.h"
#include "base/sha256.h"
#include "emu/image/elf_file.h"
#include "emu/image/image_file.h"
#include "emu/image/intel_hex.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::image {

namespace {

constexpr std::uint32_t kRam = 0x800000, kEeprom = 0x810000, kFuses = 0x820000, kLock = 0x830000,
                        kSignature = 0x840000, kBank = 0x10000;
constexpr std::uint32_t kArchitectureMask = 0x7F;  // of e_flags
constexpr std::string_view kDeviceNote = ".note.gnu.avr.deviceinfo";

/// The part's name out of the note: header, "AVR", six numbers, a table of offsets, then the strings.
std::string noted_chip(const ElfFile& elf) {
    for (const Elf32_Shdr& header : elf.sections()) {
        if (elf.section_name(header) != kDeviceNote) continue;
        constexpr std::uint64_t kOffsetCount = 16 + 6 * 4;  // of the table of offsets into the strings
        const ByteReader& reader = elf.reader();
        elf.data(header);  // checks that the section lies within the file
        const std::uint64_t table = header.sh_offset + kOffsetCount;
        const std::uint64_t strings = table + reader.u32(table, "the device note");
        const std::uint64_t name = strings + reader.u32(table + 4, "the device note");
        return std::string(reader.text(name, header.sh_offset + header.sh_size, "the device's name"));
    }
    return {};
}

Symbol avr_symbol_of(const Elf32_Shdr* section, std::uint32_t value) {
    if (!section) return {value, Space::Absolute};
    if ((section->sh_flags & SHF_EXECINSTR) != 0) return {value, Space::Program};
    return {value >= kRam && value < kEeprom ? value - kRam : value, Space::Data};
}

void read_avr_elf(std::string_view bytes, AvrImage& image, const AvrPart& part, ByteSegments& flash,
                  ByteSegments& eeprom) {
    const ElfFile elf(bytes, image.file, kMachineAvr, "83 (AVR)");
    image.architecture = static_cast<int>(elf.flags() & kArchitectureMask);
    if (image.architecture != part.architecture)
        elf.reader().fail(offsetof(Elf32_Ehdr, e_flags),
                          fmt::format("is for another AVR, architecture avr{}", image.architecture),
                          fmt::format("avr{}, as -mmcu={} gives", part.architecture, part.name));
    image.chip = noted_chip(elf);
    for (const Elf32_Phdr& segment : elf.segments()) {
        if (segment.p_type != PT_LOAD || segment.p_filesz == 0) continue;
        const std::uint32_t address = segment.p_paddr;
        const std::string place = fmt::format("segment at 0x{:x}", address);
        const std::string_view data = elf.reader().slice(segment.p_offset, segment.p_filesz, place);
        if (address < kRam)
            flash.add(address, {data.begin(), data.end()}, place);
        else if (address >= kEeprom && address < kEeprom + kBank)
            eeprom.add(address - kEeprom, {data.begin(), data.end()}, place);
        else if (address >= kFuses && address < kFuses + kBank)
            image.fuses.assign(data.begin(), data.end());
        else if (address >= kLock && address < kLock + kBank)
            image.lock_bits = static_cast<std::uint8_t>(data[0]);
        else if (address < kSignature)
            throw InputError(image.file, place, "holds bytes where no memory can be programmed");
    }
    elf.read_symbols(image.symbols, &avr_symbol_of);
    image.lines = read_lines(elf);
}

/// Pieces of a HEX file go to the memories that their addresses mean.
void read_avr_hex(std::string_view bytes, AvrImage& image, ByteSegments& eeprom) {
    for (ByteSegment& segment : parse_intel_hex(bytes, image.file)) {
        const std::uint64_t address = segment.address;
        const std::string place = fmt::format("address 0x{:x}", address);
        if (address >= kEeprom && address < kFuses)
            eeprom.add(address - kEeprom, std::move(segment.bytes), place);
        else if (address == kFuses)
            image.fuses = std::move(segment.bytes);
        else if (address == kLock)
            image.lock_bits = segment.bytes[0];
        else
            image.flash.push_back(std::move(segment));
    }
}

/// The bytes that are not erased, in rows of 16.
void add_written(std::vector<ByteSegment>& all, const std::vector<ByteSegment>& segments,
                 std::uint64_t base) {
    constexpr std::size_t kRow = 16;
    constexpr std::uint8_t kErased = 0xFF;
    for (const ByteSegment& segment : segments)
        for (std::size_t at = 0; at < segment.bytes.size(); at += kRow) {
            const auto from = segment.bytes.begin() + static_cast<std::ptrdiff_t>(at);
            const auto to = segment.bytes.begin() +
                            static_cast<std::ptrdiff_t>(std::min(at + kRow, segment.bytes.size()));
            if (std::any_of(from, to, [](std::uint8_t byte) { return byte != kErased; }))
                all.push_back({base + segment.address + at, {from, to}});
        }
}

void check_fits(const std::vector<ByteSegment>& segments, std::uint32_t size, std::string_view what,
                const AvrImage& image, const AvrPart& part) {
    for (const ByteSegment& segment : segments)
        if (segment.end() > size)
            throw InputError(image.file, fmt::format("{} address 0x{:x}", what, segment.end() - 1),
                             fmt::format("lies past the {} of the {}", what, part.name),
                             fmt::format("below 0x{:x}", size));
}

/// The P and the plain part differ in power consumption only.
bool same_part(std::string_view noted, std::string_view name) {
    return noted == name || std::string(noted) + "p" == name;
}

}  // namespace

std::optional<std::uint32_t> AvrImage::find_code(std::string_view name) const {
    const auto found = symbols.find(std::string(name));
    if (found == symbols.end() || found->second.space != Space::Program) return std::nullopt;
    return found->second.address;
}

AvrImage parse_avr_image(std::string_view bytes, const std::string& file, const AvrPart& part) {
    AvrImage image;
    image.file = file;
    image.sha256 = sha256_text(bytes);
    if (bytes.empty()) throw InputError(file, "", "is empty", "a HEX or ELF image");
    ByteSegments eeprom(file);
    if (is_elf(bytes)) {
        image.format = Format::Elf;
        ByteSegments flash(file);
        read_avr_elf(bytes, image, part, flash, eeprom);
        image.flash = flash.joined();
        image.eeprom = eeprom.joined();
    } else if (looks_like_hex(bytes)) {
        read_avr_hex(bytes, image, eeprom);
        image.eeprom = eeprom.joined();
    } else {
        throw InputError(file, "offset 0x0", "is in no known image format",
                         "Intel HEX (':' first) or ELF32 of avr-gcc");
    }
    if (!image.chip.empty() && !same_part(image.chip, part.name))
        throw InputError(file, "", fmt::format("is for the {}", image.chip), part.name);
    if (image.flash.empty()) throw InputError(file, "", "holds no program bytes", "firmware");
    check_fits(image.flash, part.flash_bytes, "flash", image, part);
    check_fits(image.eeprom, part.eeprom_bytes, "EEPROM", image, part);
    return image;
}

std::string write_avr_hex(const AvrImage& image) {
    std::vector<ByteSegment> all;
    add_written(all, image.flash, 0);
    add_written(all, image.eeprom, kEeprom);
    if (!image.fuses.empty()) all.push_back({kFuses, image.fuses});
    if (image.lock_bits) all.push_back({kLock, {*image.lock_bits}});
    return write_intel_hex(all);
}

AvrImage load_avr_image(const std::string& path, const AvrPart& part) {
    return parse_avr_image(read_image_file(path), path, part);
}

}  // namespace puckloop::image
