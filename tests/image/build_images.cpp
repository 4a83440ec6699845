#include "tests/image/build_images.h"

#include "emu/image/intel_hex.h"

#include <elf.h>

#include <cstring>
#include <vector>

namespace puckloop::image::testing {

namespace {

constexpr std::uint32_t kTextAddress = 0x100;
constexpr std::uint32_t kDataAddress = 0x800;
constexpr Elf32_Half kMachine = 118;

void put16(std::string& out, std::uint32_t value) {
    out += static_cast<char>(value & 0xFF);
    out += static_cast<char>(value >> 8 & 0xFF);
}

void put32(std::string& out, std::uint32_t value) {
    put16(out, value);
    put16(out, value >> 16);
}

std::string words_from(std::uint32_t first, std::uint32_t last) {
    std::string out;
    for (const auto& [address, word] : sample_words())
        if (address >= first && address <= last) put32(out, word);
    return out;
}

struct Part {
    const char* name;
    std::uint32_t address;
    std::uint32_t last;
    bool program;
};

const Part kParts[] = {{".reset", 0, 2, true},
                       {".text", kTextAddress, 0x1FE, true},
                       {"__FOSC", 0xF80000, 0xF80000, true},
                       {".eedata_with_a_long_name", 0x7FF000, 0x7FF000, true},
                       {".bss", kDataAddress, 0, false}};

}  // namespace

Words sample_words() {
    return {{0x000000, 0x040100}, {0x000002, 0x000000}, {0x000100, 0x20000F}, {0x000102, 0xEB0000},
            {0x000104, 0xE80000}, {0x000106, 0x37FFFE}, {0x7FF000, 0x001234}, {0xF80000, 0x00C706}};
}

std::string hex_image() {
    return write_dspic_hex(sample_words());
}

std::string elf_image() {
    std::string names(1, '\0');
    std::string strings(1, '\0');
    const auto intern = [](std::string& table, const char* name) {
        const auto at = static_cast<Elf32_Word>(table.size());
        table += name;
        table += '\0';
        return at;
    };
    std::string file(sizeof(Elf32_Ehdr), '\0');
    std::vector<Elf32_Shdr> headers(1);
    const auto add = [&](const char* name, Elf32_Word type, Elf32_Word flags, Elf32_Addr address,
                         const std::string& data) -> Elf32_Shdr& {
        Elf32_Shdr header{};
        header.sh_name = intern(names, name);
        header.sh_type = type;
        header.sh_flags = flags;
        header.sh_addr = address;
        header.sh_offset = static_cast<Elf32_Off>(file.size());
        header.sh_size = static_cast<Elf32_Word>(data.size());
        header.sh_addralign = 2;
        file += data;
        headers.push_back(header);
        return headers.back();
    };
    for (const Part& part : kParts) {
        if (part.program)
            add(part.name, SHT_PROGBITS, SHF_ALLOC | SHF_EXECINSTR, part.address,
                words_from(part.address, part.last));
        else
            add(part.name, SHT_NOBITS, SHF_ALLOC | SHF_WRITE, part.address, "").sh_size = 16;
    }
    std::string symbols(sizeof(Elf32_Sym), '\0');
    const auto symbol = [&](const char* name, std::uint32_t value, unsigned bind, Elf32_Half section) {
        Elf32_Sym entry{};
        entry.st_name = intern(strings, name);
        entry.st_value = value;
        entry.st_info = static_cast<unsigned char>(ELF32_ST_INFO(bind, STT_NOTYPE));
        entry.st_shndx = section;
        symbols.append(reinterpret_cast<const char*>(&entry), sizeof entry);
    };
    symbol(".L1", 0x104, STB_LOCAL, 2);
    symbol("_main", 0x102, STB_GLOBAL, 2);
    symbol("_counter", kDataAddress, STB_GLOBAL, 5);
    symbol("__30F6014A", 1, STB_LOCAL, SHN_ABS);
    Elf32_Shdr& table = add(".symtab", SHT_SYMTAB, 0, 0, symbols);
    table.sh_entsize = sizeof(Elf32_Sym);
    table.sh_link = static_cast<Elf32_Word>(headers.size());
    add(".strtab", SHT_STRTAB, 0, 0, strings);
    const Elf32_Word names_at = intern(names, ".shstrtab");
    add("", SHT_STRTAB, 0, 0, names).sh_name = names_at;
    headers.back().sh_size = static_cast<Elf32_Word>(names.size());
    file.resize(headers.back().sh_offset);
    file += names;

    Elf32_Ehdr header{};
    std::memcpy(header.e_ident, ELFMAG, SELFMAG);
    header.e_ident[EI_CLASS] = ELFCLASS32;
    header.e_ident[EI_DATA] = ELFDATA2LSB;
    header.e_ident[EI_VERSION] = EV_CURRENT;
    header.e_type = ET_EXEC;
    header.e_machine = kMachine;
    header.e_version = EV_CURRENT;
    header.e_ehsize = sizeof(Elf32_Ehdr);
    header.e_shoff = static_cast<Elf32_Off>(file.size());
    header.e_shentsize = sizeof(Elf32_Shdr);
    header.e_shnum = static_cast<Elf32_Half>(headers.size());
    header.e_shstrndx = static_cast<Elf32_Half>(headers.size() - 1);
    std::memcpy(file.data(), &header, sizeof header);
    file.append(reinterpret_cast<const char*>(headers.data()), headers.size() * sizeof(Elf32_Shdr));
    return file;
}

std::string coff_image() {
    constexpr std::uint32_t kOptionalSize = 28;
    const std::uint32_t sections_at = 20 + kOptionalSize;
    std::string strings;
    std::string data;
    std::string headers;
    const auto name8 = [&](std::string& out, std::string name, bool section) {
        if (name.size() > 8) {
            const auto offset = static_cast<std::uint32_t>(4 + strings.size());
            strings += name + '\0';
            if (!section) {
                put32(out, 0);
                put32(out, offset);
                return;
            }
            name = "/" + std::to_string(offset);
        }
        name.resize(8, '\0');
        out += name;
    };
    const auto data_at = static_cast<std::uint32_t>(sections_at + 40 * std::size(kParts));
    for (const Part& part : kParts) {
        const std::string content = part.program ? words_from(part.address, part.last) : "";
        name8(headers, part.name, true);
        put32(headers, part.address);
        put32(headers, part.address);
        put32(headers, part.program ? static_cast<std::uint32_t>(content.size()) : 16);
        put32(headers, part.program ? static_cast<std::uint32_t>(data_at + data.size()) : 0);
        put32(headers, 0);
        put32(headers, 0);
        put32(headers, 0);
        put32(headers, part.program ? 0x10000020 : 0x10000080);
        data += content;
    }
    std::string symbols;
    const auto symbol = [&](const char* name, std::uint32_t value, std::uint16_t section, int storage) {
        name8(symbols, name, false);
        put32(symbols, value);
        put16(symbols, section);
        put16(symbols, 0);
        symbols += static_cast<char>(storage);
        symbols += '\0';
    };
    symbol("_main", 0x102, 2, 2);
    symbol("_counter", kDataAddress, 5, 2);
    symbol("__30F6014A", 1, 0xFFFF, 3);
    std::string file;
    put16(file, 0x1236);
    put16(file, static_cast<std::uint32_t>(std::size(kParts)));
    put32(file, 0);
    put32(file, static_cast<std::uint32_t>(data_at + data.size()));
    put32(file, static_cast<std::uint32_t>(symbols.size() / 18));
    put16(file, kOptionalSize);
    put16(file, 0x0103);
    file += std::string(kOptionalSize, '\0') + headers + data + symbols;
    put32(file, static_cast<std::uint32_t>(4 + strings.size()));
    return file + strings;
}

}  // namespace puckloop::image::testing
