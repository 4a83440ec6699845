#include "cosim/resume/state_file.h"

#include "base/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nettle/sha2.h>

#include <array>
#include <cstring>
#include <fstream>

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

std::string hash_of_program() {
    std::ifstream in("/proc/self/exe", std::ios::binary);
    sha256_ctx context;
    sha256_init(&context);
    std::array<char, 65536> buffer{};
    while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
        std::array<std::uint8_t, 65536> bytes{};
        std::memcpy(bytes.data(), buffer.data(), static_cast<std::size_t>(in.gcount()));
        sha256_update(&context, static_cast<std::size_t>(in.gcount()), bytes.data());
    }
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    sha256_digest(&context, digest.size(), digest.data());
    return hexadecimal(digest);
}

}  // namespace

const std::string& build_id() {
    static const std::string id = [] {
        std::string found;
        dl_iterate_phdr(find_note, &found);
        return found.empty() ? hash_of_program() : found;
    }();
    return id;
}

}  // namespace puckloop::cosim
