#include "emu/image/elf.h"

#include "base/error.h"
#include "emu/image/byte_reader.h"
#include "emu/image/dspic_view.h"

#include <fmt/format.h>
#include <libelf.h>

#include <cstring>
#include <memory>
#include <optional>

namespace puckloop::image {

namespace {

constexpr Elf32_Half kMachineDspic30F = 118;
constexpr Elf32_Half kMachineAvr = 83;
constexpr std::uint32_t kEepromStart = 0x7FF000;

struct CloseElf {
    void operator()(Elf* elf) const { elf_end(elf); }
};

class ElfReader {
  public:
    ElfReader(std::string_view bytes, Image& image)
        : copy_(bytes), reader_(bytes, image.file), image_(image) {
        elf_version(EV_CURRENT);
        check_header();
        elf_.reset(elf_memory(copy_.data(), copy_.size()));
        if (!elf_ || !elf32_getehdr(elf_.get())) fail_libelf(0);
    }

    void read() {
        read_sections();
        read_symbols();
    }

  private:
    [[noreturn]] void fail_libelf(std::uint64_t offset) const {
        const char* reason = elf_errmsg(-1);
        reader_.fail(offset, fmt::format("libelf: {}", reason ? reason : "unreadable"), "a sound ELF32 file");
    }

    /// Every table must lie within the file before libelf sees it.
    void check_header() const {
        constexpr std::uint64_t kHeader = sizeof(Elf32_Ehdr);
        reader_.slice(0, kHeader, "the ELF header");
        if (reader_.u8(EI_CLASS, "") != ELFCLASS32)
            reader_.fail(EI_CLASS, "is not a 32-bit ELF file", "ELFCLASS32");
        if (reader_.u8(EI_DATA, "") != ELFDATA2LSB)
            reader_.fail(EI_DATA, "is not little-endian", "ELFDATA2LSB");
        const std::uint16_t type = reader_.u16(offsetof(Elf32_Ehdr, e_type), "");
        const std::uint16_t machine = reader_.u16(offsetof(Elf32_Ehdr, e_machine), "");
        if (machine != kMachineDspic30F)
            reader_.fail(offsetof(Elf32_Ehdr, e_machine),
                         fmt::format("is for another processor, e_machine {}{}", machine,
                                     machine == kMachineAvr ? " (AVR)" : ""),
                         "118 (dsPIC30F, dsPIC33F)");
        if (type != ET_EXEC)
            reader_.fail(offsetof(Elf32_Ehdr, e_type), fmt::format("is not a linked image, e_type {}", type),
                         "2 (executable)");
        const auto table = [&](std::size_t offset_at, std::size_t count_at, std::size_t size_at,
                               std::uint64_t entry, std::string_view what) {
            const std::uint64_t offset = reader_.u32(offset_at, "");
            const std::uint64_t count = reader_.u16(count_at, "");
            if (count == 0) return;
            if (reader_.u16(size_at, "") != entry)
                reader_.fail(size_at,
                             fmt::format("{} with entries of {} bytes", what, reader_.u16(size_at, "")),
                             fmt::format("{}", entry));
            reader_.slice(offset, count * entry, what);
        };
        table(offsetof(Elf32_Ehdr, e_shoff), offsetof(Elf32_Ehdr, e_shnum), offsetof(Elf32_Ehdr, e_shentsize),
              sizeof(Elf32_Shdr), "the section table");
        table(offsetof(Elf32_Ehdr, e_phoff), offsetof(Elf32_Ehdr, e_phnum), offsetof(Elf32_Ehdr, e_phentsize),
              sizeof(Elf32_Phdr), "the segment table");
        if (reader_.u16(offsetof(Elf32_Ehdr, e_shnum), "") == 0)
            reader_.fail(offsetof(Elf32_Ehdr, e_shnum), "has no section table",
                         "the sections of a linked image");
    }

    /// A copy: libelf's pointer leads into the file, where a damaged offset may be misaligned.
    std::optional<Elf32_Shdr> header_of(Elf_Scn* section) const {
        const void* header = section ? elf32_getshdr(section) : nullptr;
        if (!header) return std::nullopt;
        Elf32_Shdr copy;
        std::memcpy(&copy, header, sizeof copy);
        return copy;
    }

    std::string section_name(const Elf32_Shdr& header) const {
        std::size_t strings = 0;
        if (elf_getshdrstrndx(elf_.get(), &strings) != 0) return "?";
        const char* name = elf_strptr(elf_.get(), strings, header.sh_name);
        return name ? name : "?";
    }

    /// Where a section is placed: its segment may lie elsewhere than it is addressed (.const through PSV).
    std::uint32_t load_address(const Elf32_Shdr& header) const {
        std::size_t count = 0;
        elf_getphdrnum(elf_.get(), &count);
        const void* segments = count ? elf32_getphdr(elf_.get()) : nullptr;
        for (std::size_t i = 0; segments && i < count; ++i) {
            Elf32_Phdr segment;
            std::memcpy(&segment, static_cast<const char*>(segments) + i * sizeof segment, sizeof segment);
            if (segment.p_type == PT_LOAD && header.sh_offset >= segment.p_offset &&
                header.sh_offset - segment.p_offset < segment.p_filesz)
                return header.sh_addr - segment.p_vaddr + segment.p_paddr;
        }
        return header.sh_addr;
    }

    static bool is_program(const Elf32_Shdr& header) {
        return header.sh_type == SHT_PROGBITS && (header.sh_flags & SHF_ALLOC) != 0 &&
               ((header.sh_flags & SHF_WRITE) == 0 || header.sh_addr >= kEepromStart);
    }

    void read_sections() {
        ByteSegments segments(image_.file);
        for (Elf_Scn* section = elf_nextscn(elf_.get(), nullptr); section;
             section = elf_nextscn(elf_.get(), section)) {
            const std::optional<Elf32_Shdr> header = header_of(section);
            if (!header) fail_libelf(0);
            if (!is_program(*header)) continue;
            const std::string name = "section " + section_name(*header);
            const std::string_view data = reader_.slice(header->sh_offset, header->sh_size, name);
            segments.add(std::uint64_t{load_address(*header)} * 2, {data.begin(), data.end()}, name);
        }
        add_words(image_, segments.joined());
    }

    void read_symbols() {
        for (Elf_Scn* section = elf_nextscn(elf_.get(), nullptr); section;
             section = elf_nextscn(elf_.get(), section)) {
            const std::optional<Elf32_Shdr> header = header_of(section);
            if (!header || header->sh_type != SHT_SYMTAB) continue;
            const std::string_view table =
                reader_.slice(header->sh_offset, header->sh_size, "the symbol table");
            if (header->sh_entsize != sizeof(Elf32_Sym) || table.size() % sizeof(Elf32_Sym) != 0)
                reader_.fail(header->sh_offset, "a symbol table of broken size", "entries of 16 bytes");
            for (std::size_t at = 0; at < table.size(); at += sizeof(Elf32_Sym)) {
                Elf32_Sym symbol;
                std::memcpy(&symbol, table.data() + at, sizeof symbol);
                add_symbol(symbol, header->sh_link, header->sh_offset + at);
            }
        }
    }

    Space space_of(Elf32_Half index, std::uint64_t offset) const {
        if (index == SHN_ABS) return Space::Absolute;
        const std::optional<Elf32_Shdr> header = header_of(elf_getscn(elf_.get(), index));
        if (!header)
            reader_.fail(offset, fmt::format("a symbol of section {}", index), "a section of this file");
        return (header->sh_flags & SHF_EXECINSTR) != 0 ? Space::Program : Space::Data;
    }

    void add_symbol(const Elf32_Sym& entry, Elf32_Word strings, std::uint64_t offset) {
        const unsigned type = ELF32_ST_TYPE(entry.st_info);
        if (type == STT_SECTION || type == STT_FILE || entry.st_shndx == SHN_UNDEF) return;
        if (entry.st_shndx >= SHN_LORESERVE && entry.st_shndx != SHN_ABS) return;
        const char* name = elf_strptr(elf_.get(), strings, entry.st_name);
        if (!name)
            reader_.fail(offset, "a symbol's name lies outside the string table", "an offset inside it");
        if (entry.st_shndx == SHN_ABS && image_.chip.empty()) image_.chip = chip_from_symbol(name);
        if (name[0] == '\0' || name[0] == '.') return;  // the compiler's local labels
        const Symbol symbol{entry.st_value, space_of(entry.st_shndx, offset),
                            ELF32_ST_BIND(entry.st_info) != STB_LOCAL};
        const auto [found, fresh] = image_.symbols.emplace(name, symbol);
        if (!fresh && symbol.global && !found->second.global) found->second = symbol;
    }

    std::string copy_;  // libelf wants memory it may write to
    ByteReader reader_;
    Image& image_;
    std::unique_ptr<Elf, CloseElf> elf_;
};

}  // namespace

bool is_elf(std::string_view bytes) {
    return bytes.substr(0, SELFMAG) == ELFMAG;
}

void read_elf(std::string_view bytes, Image& image) {
    ElfReader(bytes, image).read();
}

}  // namespace puckloop::image
