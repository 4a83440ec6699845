#pragma once
// Which programs the library can be preloaded into: asked by the node before it starts one, and by the
// library before a program executes another.

#include <elf.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cstring>

namespace puckloop::linuxboard::wire {

#if defined(__x86_64__)
inline constexpr int kHostMachine = EM_X86_64;
#elif defined(__aarch64__)
inline constexpr int kHostMachine = EM_AARCH64;
#else
#error "unknown host processor"
#endif

/// How many scripts may be each other's interpreters, as in Linux.
inline constexpr int kDeepestScript = 4;

struct Obstacle {
    const char* why = nullptr;  ///< after "it is"; nullptr: there is none
    const char* wanted = "";
};

/// The kernel's loader obeys no LD_PRELOAD for a program that runs with other rights than who starts it.
inline bool changes_rights(int file, const struct stat& status) {
    const bool other_user = (status.st_mode & S_ISUID) != 0 && status.st_uid != geteuid();
    const bool other_group =
        (status.st_mode & S_ISGID) != 0 && (status.st_mode & S_IXGRP) != 0 && status.st_gid != getegid();
    return other_user || other_group ||
           (geteuid() != 0 && fgetxattr(file, "security.capability", nullptr, 0) > 0);
}

/// Of the ELF file that is open as `file`; no obstacle in anything else.
inline Obstacle obstacle_of_elf(int file, const struct stat& status) {
    Elf64_Ehdr header{};
    const auto got = pread(file, &header, sizeof header, 0);
    if (got < SELFMAG || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return {};
    if (got != sizeof header || header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_machine != kHostMachine)
        return {"a program for another processor", "one built for this machine"};
    if (changes_rights(file, status))
        return {"setuid, setgid or given capabilities, so nothing can be preloaded into it",
                "a plain copy of it"};
    for (unsigned i = 0; i < header.e_phnum; ++i) {
        Elf64_Phdr segment{};
        const auto place = static_cast<off_t>(header.e_phoff + i * sizeof segment);
        if (pread(file, &segment, sizeof segment, place) != sizeof segment || segment.p_type != PT_INTERP)
            continue;
        char loader[128] = {};
        if (segment.p_filesz >= sizeof loader ||
            pread(file, loader, segment.p_filesz, static_cast<off_t>(segment.p_offset)) < 0)
            break;
        if (std::strstr(loader, "/ld-linux") != nullptr) return {};
        return {"linked with another C library than glibc, whose calls cannot be taken over",
                "one built with glibc"};
    }
    return {"statically linked, so its system calls cannot be taken over", "a dynamically linked program"};
}

}  // namespace puckloop::linuxboard::wire
