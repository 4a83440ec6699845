#include "tests/crashes/crash_image.h"

#include "tests/kit/scratch.h"

#include <elf.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

namespace puckloop::tests {

namespace {

using Bytes = std::map<std::uint32_t, std::string>;  // stretches by address

constexpr Elf32_Half kDspic = 118;
constexpr std::uint32_t kAvrData = 0x800000;  // where avr-gcc puts data space
constexpr Elf32_Word kAvr51 = 51;             // architecture, as avr-gcc notes it

/// The least of an ELF file that has code and symbols.
std::string elf(Elf32_Half machine, const Bytes& code, const Labels& labels,
                const VariablesByName& variables) {
    std::string file(sizeof(Elf32_Ehdr), '\0'), strings(1, '\0');
    std::vector<Elf32_Shdr> sections(1);
    std::vector<Elf32_Phdr> segments;
    const auto intern = [&](const std::string& name) {
        const auto at = static_cast<Elf32_Word>(strings.size());
        strings += name + '\0';
        return at;
    };
    const auto add = [&](const std::string& name, Elf32_Word type, Elf32_Word flags, std::uint32_t address,
                         const std::string& data) {
        file.resize((file.size() + 3) / 4 * 4);
        Elf32_Shdr section{};
        section.sh_name = intern(name);
        section.sh_type = type;
        section.sh_flags = flags;
        section.sh_addr = address;
        section.sh_offset = static_cast<Elf32_Off>(file.size());
        section.sh_size = static_cast<Elf32_Word>(data.size());
        section.sh_addralign = 2;
        sections.push_back(section);
        file += data;
    };
    for (const auto& [address, data] : code) {
        add(".code", SHT_PROGBITS, SHF_ALLOC | SHF_EXECINSTR, address, data);
        Elf32_Phdr segment{};
        segment.p_type = PT_LOAD;
        segment.p_offset = sections.back().sh_offset;
        segment.p_vaddr = segment.p_paddr = address;
        segment.p_filesz = segment.p_memsz = sections.back().sh_size;
        segments.push_back(segment);
    }
    const std::uint32_t data_space = machine == EM_AVR ? kAvrData : 0;
    const auto bss = static_cast<Elf32_Half>(sections.size());
    if (!variables.empty()) {
        add(".bss", SHT_NOBITS, SHF_ALLOC | SHF_WRITE, data_space + variables.begin()->second.address, {});
        sections.back().sh_size = 1;
    }
    std::string symbols(sizeof(Elf32_Sym), '\0');
    for (const auto& [name, address] : labels) {
        Elf32_Sym symbol{};
        symbol.st_name = intern(name);
        symbol.st_value = address;
        symbol.st_info = ELF32_ST_INFO(STB_GLOBAL, STT_FUNC);
        symbol.st_shndx = 1;
        symbols.append(reinterpret_cast<const char*>(&symbol), sizeof symbol);
    }
    for (const auto& [name, variable] : variables) {
        Elf32_Sym symbol{};
        symbol.st_name = intern(name);
        symbol.st_value = data_space + variable.address;
        symbol.st_size = variable.bytes;
        symbol.st_info = ELF32_ST_INFO(STB_GLOBAL, STT_OBJECT);
        symbol.st_shndx = bss;
        symbols.append(reinterpret_cast<const char*>(&symbol), sizeof symbol);
    }
    add(".symtab", SHT_SYMTAB, 0, 0, symbols);
    sections.back().sh_entsize = sizeof(Elf32_Sym);
    sections.back().sh_link = static_cast<Elf32_Word>(sections.size());
    intern(".strtab");
    add(".strtab", SHT_STRTAB, 0, 0, strings);
    sections.back().sh_size = static_cast<Elf32_Word>(strings.size());
    file.resize(sections.back().sh_offset);
    file += strings;
    file.resize((file.size() + 3) / 4 * 4);
    Elf32_Ehdr header{};
    std::memcpy(header.e_ident, ELFMAG, SELFMAG);
    header.e_ident[EI_CLASS] = ELFCLASS32;
    header.e_ident[EI_DATA] = ELFDATA2LSB;
    header.e_ident[EI_VERSION] = EV_CURRENT;
    header.e_type = ET_EXEC;
    header.e_machine = machine;
    if (machine == EM_AVR) header.e_flags = kAvr51;
    header.e_version = EV_CURRENT;
    header.e_ehsize = sizeof(Elf32_Ehdr);
    header.e_phoff = static_cast<Elf32_Off>(file.size());
    header.e_phentsize = sizeof(Elf32_Phdr);
    header.e_phnum = static_cast<Elf32_Half>(segments.size());
    file.append(reinterpret_cast<const char*>(segments.data()), segments.size() * sizeof(Elf32_Phdr));
    header.e_shoff = static_cast<Elf32_Off>(file.size());
    header.e_shentsize = sizeof(Elf32_Shdr);
    header.e_shnum = static_cast<Elf32_Half>(sections.size());
    header.e_shstrndx = static_cast<Elf32_Half>(sections.size() - 1);
    file.append(reinterpret_cast<const char*>(sections.data()), sections.size() * sizeof(Elf32_Shdr));
    std::memcpy(file.data(), &header, sizeof header);
    return file;
}

/// Words of a program as stretches of bytes.
template <class Word>
Bytes stretches(const std::map<std::uint32_t, Word>& words, int bytes_of_word) {
    Bytes all;
    std::uint32_t next = ~0u;
    std::string* last = nullptr;
    for (const auto& [address, word] : words) {
        if (address != next) last = &all[address];
        for (int i = 0; i < bytes_of_word; ++i)
            *last += static_cast<char>(static_cast<std::uint32_t>(word) >> 8 * i & 0xFF);
        next = address + (bytes_of_word == 1 ? 1 : 2);
    }
    return all;
}

}  // namespace

std::string dspic_elf(const std::map<std::uint32_t, std::uint32_t>& words, const Labels& labels,
                      const VariablesByName& variables) {
    return elf(kDspic, stretches(words, 4), labels, variables);
}

std::string avr_elf(const std::map<std::uint32_t, std::uint8_t>& bytes, const Labels& labels,
                    const VariablesByName& variables) {
    return elf(EM_AVR, stretches(bytes, 1), labels, variables);
}

ImageFile::ImageFile(const std::string& name, const std::string& content)
    : path(scratch_path(name).string() + ".elf") {
    std::ofstream(path, std::ios::binary) << content;
}

ImageFile::~ImageFile() {
    std::filesystem::remove(path);
}

}  // namespace puckloop::tests
