#include "emu/image/elf.h"

#include "emu/image/dspic_view.h"
#include "emu/image/elf_file.h"

namespace puckloop::image {

namespace {

/// Where a section is placed: its segment may lie elsewhere than it is addressed (.const through PSV).
std::uint32_t load_address(const ElfFile& elf, const Elf32_Shdr& header) {
    for (const Elf32_Phdr& segment : elf.segments())
        if (segment.p_type == PT_LOAD && header.sh_offset >= segment.p_offset &&
            header.sh_offset - segment.p_offset < segment.p_filesz)
            return header.sh_addr - segment.p_vaddr + segment.p_paddr;
    return header.sh_addr;
}

bool is_program(const Elf32_Shdr& header) {
    return header.sh_type == SHT_PROGBITS && (header.sh_flags & SHF_ALLOC) != 0 &&
           ((header.sh_flags & SHF_WRITE) == 0 || header.sh_addr >= kEepromStart);
}

Symbol dspic_symbol_of(const Elf32_Shdr* section, std::uint32_t value) {
    if (!section) return {value, Space::Absolute};
    return {value, (section->sh_flags & SHF_EXECINSTR) != 0 ? Space::Program : Space::Data};
}

}  // namespace

void read_elf(std::string_view bytes, Image& image) {
    const ElfFile elf(bytes, image.file, kMachineDspic30F, "118 (dsPIC30F, dsPIC33F)");
    ByteSegments segments(image.file);
    for (const Elf32_Shdr& header : elf.sections()) {
        if (!is_program(header)) continue;
        const std::string_view data = elf.data(header);
        segments.add(std::uint64_t{load_address(elf, header)} * 2, {data.begin(), data.end()},
                     "section " + elf.section_name(header));
    }
    add_words(image, segments.joined());
    elf.read_symbols(image.symbols, &dspic_symbol_of, [&image](std::string_view name) {
        if (image.chip.empty()) image.chip = chip_from_symbol(name);
    });
}

}  // namespace puckloop::image
