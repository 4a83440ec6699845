// printf(), getline(), freopen(), perror() and everything else in the C library that reads or writes calls
// its functions write(), read() and so on directly, past any library that is preloaded; glob(), scandir() and
// nftw() do so with folders. So the beginning of those functions is replaced by a jump to the ones here. What
// they do with descriptors that are neither devices nor pipes is what they did before: no time passes.

#include "linuxboard/shim/preload/libc_hooks.h"

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <gnu/lib-names.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstring>

namespace puckloop::shim {

namespace {
bool is_ours(int fd) {
    return active() && (open_file(fd) != nullptr || is_channel(fd));
}

ssize_t hooked_read(int fd, void* buffer, size_t size) {
    return is_ours(fd) ? read(fd, buffer, size) : REAL(read)(fd, buffer, size);
}

ssize_t hooked_write(int fd, const void* data, size_t size) {
    return is_ours(fd) ? write(fd, data, size) : REAL(write)(fd, data, size);
}

off_t hooked_lseek(int fd, off_t offset, int from) {
    return open_file(fd) != nullptr ? lseek(fd, offset, from) : REAL(lseek)(fd, offset, from);
}

int hooked_open(const char* path, int flags, ...) {
    std::va_list list;
    va_start(list, flags);
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(list, mode_t) : 0;
    va_end(list);
    return open(path, flags, mode);
}

int hooked_openat(int folder, const char* path, int flags, ...) {
    std::va_list list;
    va_start(list, flags);
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(list, mode_t) : 0;
    va_end(list);
    return openat(folder, path, flags, mode);
}

int hooked_close(int fd) {
    return close(fd);
}

/// Of a stream: fclose(), freopen().
int hooked_stream_close(FILE* file) {
    return close(file->_fileno);
}

int hooked_dup(int fd) {
    return dup(fd);
}

int hooked_dup2(int fd, int copy) {
    return dup2(fd, copy);
}

int hooked_dup3(int fd, int copy, int flags) {
    return dup3(fd, copy, flags);
}

int hooked_tcgetattr(int fd, termios* settings) {
    return tcgetattr(fd, settings);
}

ssize_t hooked_getdents64(int fd, void* entries, size_t room) {
    return getdents64(fd, entries, room);
}

DIR* hooked_opendir(const char* path) {
    return opendir(path);
}

int hooked_fstatat64(int folder, const char* path, struct stat64* status, int flags) {
    return fstatat64(folder, path, status, flags);
}

struct Hook {
    const char* name;
    std::uintptr_t target;
    bool recent = false;  ///< older C libraries have it not, and no other that calls it
};
template <typename Function>
std::uintptr_t address(Function* function) {
    return reinterpret_cast<std::uintptr_t>(function);
}

#if defined(__x86_64__)
constexpr std::size_t kJumpSize = 14;
std::array<unsigned char, kJumpSize> jump_to(std::uintptr_t target) {
    std::array<unsigned char, kJumpSize> code{0xff, 0x25, 0, 0, 0, 0};  // jmp *0(%rip)
    std::memcpy(code.data() + 6, &target, sizeof target);
    return code;
}
#elif defined(__aarch64__)
constexpr std::size_t kJumpSize = 16;
std::array<unsigned char, kJumpSize> jump_to(std::uintptr_t target) {
    // ldr x16, .+8; br x16
    std::array<unsigned char, kJumpSize> code{0x50, 0, 0, 0x58, 0, 0x02, 0x1f, 0xd6};
    std::memcpy(code.data() + 8, &target, sizeof target);
    return code;
}
#else
#error "unknown host processor"
#endif

/// Functions begin at multiples of it, so that one has as many bytes for itself.
constexpr std::uintptr_t kAlignment = 16;
static_assert(kJumpSize <= kAlignment);

bool replace(void* function, std::uintptr_t target) {
    constexpr std::uintptr_t kPage = 4096;
    const auto place = reinterpret_cast<std::uintptr_t>(function);
    if (place % kAlignment != 0) return false;
    const std::uintptr_t page_start = place / kPage * kPage;  // all of it is in one page
    const auto protect = [page_start](long protection) {
        return host_call(SYS_mprotect, static_cast<long>(page_start), kPage, protection) == 0;
    };
    if (!protect(PROT_READ | PROT_WRITE | PROT_EXEC)) return false;
    const auto code = jump_to(target);
    std::memcpy(function, code.data(), code.size());
    __builtin___clear_cache(static_cast<char*>(function), static_cast<char*>(function) + code.size());
    return protect(PROT_READ | PROT_EXEC);
}
}  // namespace

void hook_libc() {
    const Hook hooks[] = {
        {"read", address(hooked_read)},
        {"write", address(hooked_write)},
        {"lseek64", address(hooked_lseek)},
        {"open64", address(hooked_open)},
        {"openat64", address(hooked_openat)},
        {"close", address(hooked_close)},
        {"_IO_file_close", address(hooked_stream_close)},
        {"dup", address(hooked_dup)},
        {"dup2", address(hooked_dup2)},
        {"dup3", address(hooked_dup3)},
        {"tcgetattr", address(hooked_tcgetattr)},
        {"opendir", address(hooked_opendir)},
        {"getdents64", address(hooked_getdents64), true},
        {"fstatat64", address(hooked_fstatat64), true},
    };
    void* const libc = dlopen(LIBC_SO, RTLD_LAZY | RTLD_NOLOAD);
    for (const Hook& hook : hooks) {
        void* const function = libc != nullptr ? dlsym(libc, hook.name) : nullptr;
        if (function == nullptr && hook.recent) continue;
        if (function == nullptr || !replace(function, hook.target))
            refuse(
                "the C library's functions cannot be taken over (is this glibc, may its code be changed?)");
    }
}

}  // namespace puckloop::shim
