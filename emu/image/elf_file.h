#pragma once
// A linked little-endian ELF32 file through libelf, whatever processor it is for. Every table is checked to
// lie within the file before libelf sees it. Source: System V ABI (ELF).

#include "emu/image/byte_reader.h"
#include "emu/image/image.h"

#include <libelf.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::image {

bool is_elf(std::string_view bytes);
/// e_machine of an ELF file; 0 if the header is cut short.
std::uint16_t elf_machine(std::string_view bytes);

inline constexpr std::uint16_t kMachineDspic30F = 118;
inline constexpr std::uint16_t kMachineAvr = 83;

class ElfFile {
  public:
    /// `machine`: the e_machine it must have; `machine_text` names it in the message. Throws InputError
    /// naming the offset.
    ElfFile(std::string_view bytes, const std::string& file, std::uint16_t machine,
            std::string_view machine_text);

    const ByteReader& reader() const { return reader_; }
    std::uint32_t flags() const;  ///< e_flags
    std::vector<Elf32_Shdr> sections() const;
    std::vector<Elf32_Phdr> segments() const;
    std::string section_name(const Elf32_Shdr& header) const;
    /// What the file holds of a section.
    std::string_view data(const Elf32_Shdr& header) const;

    /// Named symbols but those of sections, files and the compiler's own; `space_of` sees the section (none
    /// for absolute ones) and the value. A global one wins over a local one.
    using SpaceOf = std::function<Symbol(const Elf32_Shdr* section, std::uint32_t value)>;
    void read_symbols(std::map<std::string, Symbol>& symbols, const SpaceOf& space_of,
                      const std::function<void(std::string_view name)>& on_absolute = nullptr) const;
    /// Bytes of each variable that the symbol table knows the size of; a global one wins over a local one.
    std::map<std::string, std::uint32_t> object_sizes() const;

  private:
    struct CloseElf {
        void operator()(Elf* elf) const { elf_end(elf); }
    };
    [[noreturn]] void fail_libelf(std::uint64_t offset) const;
    void check_header(std::uint16_t machine, std::string_view machine_text) const;
    std::optional<Elf32_Shdr> header_of(Elf_Scn* section) const;

    std::string copy_;  // libelf wants memory it may write to
    ByteReader reader_;
    std::unique_ptr<Elf, CloseElf> elf_;
};

}  // namespace puckloop::image
