#include "emu/image/symbol_sizes.h"

#include "emu/image/elf_file.h"
#include "emu/image/image_file.h"

namespace puckloop::image {

std::map<std::string, std::uint32_t> symbol_sizes(const std::string& path) {
    const std::string bytes = read_image_file(path);
    if (!is_elf(bytes)) return {};
    return ElfFile(bytes, path, elf_machine(bytes), "this chip's").object_sizes();
}

}  // namespace puckloop::image
