#include "cosim/resume/state_file.h"

#include "base/error.h"
#include "base/sha256.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstring>

#include <elf.h>
#include <link.h>

namespace puckloop::cosim {

namespace {

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

/// The program itself is the first that dl_iterate_phdr() names; its libraries of this project are in it.
int find_note(dl_phdr_info* info, std::size_t, void* found) {
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const ElfW(Phdr)& header = info->dlpi_phdr[i];
        if (header.p_type != PT_NOTE) continue;
        // NOLINTNEXTLINE: the loader gives the address as a number
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(info->dlpi_addr + header.p_vaddr);
        for (std::size_t at = 0; at + sizeof(ElfW(Nhdr)) <= header.p_memsz;) {
            ElfW(Nhdr) note;
            std::memcpy(&note, bytes + at, sizeof note);
            const std::size_t name = at + sizeof note;
            const std::size_t content = name + (note.n_namesz + 3u) / 4 * 4;
            if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 &&
                std::memcmp(bytes + name, "GNU", 4) == 0)
                *static_cast<std::string*>(found) = hexadecimal({bytes + content, note.n_descsz});
            at = content + (note.n_descsz + 3u) / 4 * 4;
        }
    }
    return 1;  // no further objects
}

}  // namespace

const std::string& build_id() {
    static const std::string id = [] {
        std::string found;
        dl_iterate_phdr(find_note, &found);
        return found.empty() ? sha256_of_file("/proc/self/exe") : found;
    }();
    return id;
}

}  // namespace puckloop::cosim
