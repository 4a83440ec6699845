#include "emu/image/elf_file.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstring>

namespace puckloop::image {

bool is_elf(std::string_view bytes) {
    return bytes.substr(0, SELFMAG) == ELFMAG;
}

std::uint16_t elf_machine(std::string_view bytes) {
    constexpr std::size_t kAt = offsetof(Elf32_Ehdr, e_machine);
    if (bytes.size() < kAt + 2) return 0;
    return static_cast<std::uint16_t>(static_cast<unsigned char>(bytes[kAt]) |
                                      static_cast<unsigned char>(bytes[kAt + 1]) << 8);
}

ElfFile::ElfFile(std::string_view bytes, const std::string& file, std::uint16_t machine,
                 std::string_view machine_text)
    : copy_(bytes), reader_(bytes, file) {
    elf_version(EV_CURRENT);
    check_header(machine, machine_text);
    elf_.reset(elf_memory(copy_.data(), copy_.size()));
    if (!elf_ || !elf32_getehdr(elf_.get())) fail_libelf(0);
}

void ElfFile::fail_libelf(std::uint64_t offset) const {
    const char* reason = elf_errmsg(-1);
    reader_.fail(offset, fmt::format("libelf: {}", reason ? reason : "unreadable"), "a sound ELF32 file");
}

void ElfFile::check_header(std::uint16_t wanted, std::string_view machine_text) const {
    constexpr std::uint64_t kHeader = sizeof(Elf32_Ehdr);
    reader_.slice(0, kHeader, "the ELF header");
    if (reader_.u8(EI_CLASS, "") != ELFCLASS32)
        reader_.fail(EI_CLASS, "is not a 32-bit ELF file", "ELFCLASS32");
    if (reader_.u8(EI_DATA, "") != ELFDATA2LSB) reader_.fail(EI_DATA, "is not little-endian", "ELFDATA2LSB");
    const std::uint16_t type = reader_.u16(offsetof(Elf32_Ehdr, e_type), "");
    const std::uint16_t machine = reader_.u16(offsetof(Elf32_Ehdr, e_machine), "");
    if (machine != wanted) {
        const char* name = machine == kMachineAvr ? " (AVR)" : machine == kMachineDspic30F ? " (dsPIC)" : "";
        reader_.fail(offsetof(Elf32_Ehdr, e_machine),
                     fmt::format("is for another processor, e_machine {}{}", machine, name), machine_text);
    }
    if (type != ET_EXEC)
        reader_.fail(offsetof(Elf32_Ehdr, e_type), fmt::format("is not a linked image, e_type {}", type),
                     "2 (executable)");
    const auto table = [&](std::size_t offset_at, std::size_t count_at, std::size_t size_at,
                           std::uint64_t entry, std::string_view what) {
        const std::uint64_t offset = reader_.u32(offset_at, "");
        const std::uint64_t count = reader_.u16(count_at, "");
        if (count == 0) return;
        if (reader_.u16(size_at, "") != entry)
            reader_.fail(size_at, fmt::format("{} with entries of {} bytes", what, reader_.u16(size_at, "")),
                         fmt::format("{}", entry));
        reader_.slice(offset, count * entry, what);
    };
    table(offsetof(Elf32_Ehdr, e_shoff), offsetof(Elf32_Ehdr, e_shnum), offsetof(Elf32_Ehdr, e_shentsize),
          sizeof(Elf32_Shdr), "the section table");
    table(offsetof(Elf32_Ehdr, e_phoff), offsetof(Elf32_Ehdr, e_phnum), offsetof(Elf32_Ehdr, e_phentsize),
          sizeof(Elf32_Phdr), "the segment table");
    if (reader_.u16(offsetof(Elf32_Ehdr, e_shnum), "") == 0)
        reader_.fail(offsetof(Elf32_Ehdr, e_shnum), "has no section table", "the sections of a linked image");
}

std::uint32_t ElfFile::flags() const {
    return reader_.u32(offsetof(Elf32_Ehdr, e_flags), "");
}

/// A copy: libelf's pointer leads into the file, where a damaged offset may be misaligned.
std::optional<Elf32_Shdr> ElfFile::header_of(Elf_Scn* section) const {
    const void* header = section ? elf32_getshdr(section) : nullptr;
    if (!header) return std::nullopt;
    Elf32_Shdr copy;
    std::memcpy(&copy, header, sizeof copy);
    return copy;
}

std::vector<Elf32_Shdr> ElfFile::sections() const {
    std::vector<Elf32_Shdr> headers;
    for (Elf_Scn* section = elf_nextscn(elf_.get(), nullptr); section;
         section = elf_nextscn(elf_.get(), section)) {
        const std::optional<Elf32_Shdr> header = header_of(section);
        if (!header) fail_libelf(0);
        headers.push_back(*header);
    }
    return headers;
}

std::vector<Elf32_Phdr> ElfFile::segments() const {
    std::size_t count = 0;
    elf_getphdrnum(elf_.get(), &count);
    const void* table = count ? elf32_getphdr(elf_.get()) : nullptr;
    std::vector<Elf32_Phdr> headers(table ? count : 0);
    if (table) std::memcpy(headers.data(), table, count * sizeof(Elf32_Phdr));
    return headers;
}

std::string ElfFile::section_name(const Elf32_Shdr& header) const {
    std::size_t strings = 0;
    if (elf_getshdrstrndx(elf_.get(), &strings) != 0) return "?";
    const char* name = elf_strptr(elf_.get(), strings, header.sh_name);
    return name ? name : "?";
}

std::string_view ElfFile::data(const Elf32_Shdr& header) const {
    return reader_.slice(header.sh_offset, header.sh_size, "section " + section_name(header));
}

void ElfFile::read_symbols(std::map<std::string, Symbol>& symbols, const SpaceOf& space_of,
                           const std::function<void(std::string_view)>& on_absolute) const {
    for (const Elf32_Shdr& header : sections()) {
        if (header.sh_type != SHT_SYMTAB) continue;
        const std::string_view table = reader_.slice(header.sh_offset, header.sh_size, "the symbol table");
        if (header.sh_entsize != sizeof(Elf32_Sym) || table.size() % sizeof(Elf32_Sym) != 0)
            reader_.fail(header.sh_offset, "a symbol table of broken size", "entries of 16 bytes");
        for (std::size_t at = 0; at < table.size(); at += sizeof(Elf32_Sym)) {
            Elf32_Sym entry;
            std::memcpy(&entry, table.data() + at, sizeof entry);
            const std::uint64_t offset = header.sh_offset + at;
            const unsigned type = ELF32_ST_TYPE(entry.st_info);
            const bool absolute = entry.st_shndx == SHN_ABS;
            if (type == STT_SECTION || type == STT_FILE || entry.st_shndx == SHN_UNDEF) continue;
            if (entry.st_shndx >= SHN_LORESERVE && !absolute) continue;
            const char* name = elf_strptr(elf_.get(), header.sh_link, entry.st_name);
            if (!name)
                reader_.fail(offset, "a symbol's name lies outside the string table", "an offset inside it");
            if (absolute && on_absolute) on_absolute(name);
            if (name[0] == '\0' || name[0] == '.') continue;  // the compiler's local labels
            std::optional<Elf32_Shdr> section;
            if (!absolute) {
                section = header_of(elf_getscn(elf_.get(), entry.st_shndx));
                if (!section)
                    reader_.fail(offset, fmt::format("a symbol of section {}", entry.st_shndx),
                                 "a section of this file");
            }
            Symbol symbol = space_of(section ? &*section : nullptr, entry.st_value);
            symbol.global = ELF32_ST_BIND(entry.st_info) != STB_LOCAL;
            const auto [found, fresh] = symbols.emplace(name, symbol);
            if (!fresh && symbol.global && !found->second.global) found->second = symbol;
        }
    }
}

std::map<std::string, std::uint32_t> ElfFile::object_sizes() const {
    std::map<std::string, std::uint32_t> global, local;
    for (const Elf32_Shdr& header : sections()) {
        if (header.sh_type != SHT_SYMTAB) continue;
        const std::string_view table = reader_.slice(header.sh_offset, header.sh_size, "the symbol table");
        for (std::size_t at = 0; at + sizeof(Elf32_Sym) <= table.size(); at += sizeof(Elf32_Sym)) {
            Elf32_Sym entry;
            std::memcpy(&entry, table.data() + at, sizeof entry);
            const char* name = elf_strptr(elf_.get(), header.sh_link, entry.st_name);
            if (ELF32_ST_TYPE(entry.st_info) != STT_OBJECT || entry.st_size == 0 || name == nullptr) continue;
            (ELF32_ST_BIND(entry.st_info) == STB_LOCAL ? local : global).emplace(name, entry.st_size);
        }
    }
    global.merge(local);
    return global;
}

}  // namespace puckloop::image
