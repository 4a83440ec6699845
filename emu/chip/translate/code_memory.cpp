#include "emu/chip/translate/code_memory.h"

#include "base/logs/log.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace puckloop::chip {

CodeMemory::CodeMemory() {
    const int file = ::memfd_create("puckloop code", MFD_CLOEXEC);
    if (file >= 0 && ::ftruncate(file, kBytes) == 0) {
        void* const write = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        void* const run = ::mmap(nullptr, kBytes, PROT_READ | PROT_EXEC, MAP_SHARED, file, 0);
        if (write != MAP_FAILED && run != MAP_FAILED) {
            // A child that goes on without exec() must not write into its parent's code.
            ::madvise(write, kBytes, MADV_DONTFORK);
            ::madvise(run, kBytes, MADV_DONTFORK);
            writable_ = static_cast<std::uint8_t*>(write);
            executable_ = static_cast<std::uint8_t*>(run);
        } else {
            const int why = errno;
            if (write != MAP_FAILED) ::munmap(write, kBytes);
            if (run != MAP_FAILED) ::munmap(run, kBytes);
            errno = why;
        }
    }
    if (!available())
        log::warning("no executable memory on this host ({}): programs are interpreted",
                     std::strerror(errno));
    if (file >= 0) ::close(file);
}

CodeMemory::~CodeMemory() {
    if (!available()) return;
    ::munmap(writable_, kBytes);
    ::munmap(executable_, kBytes);
}

}  // namespace puckloop::chip
