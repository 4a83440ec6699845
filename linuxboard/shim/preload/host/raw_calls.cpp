#include "linuxboard/shim/preload/host/raw_calls.h"
#include "linuxboard/shim/preload/host/failure.h"

#include "linuxboard/shim/preload/host/host.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstring>

namespace puckloop::shim {

namespace {
long number_of(const void* pointer) {
    return reinterpret_cast<long>(pointer);
}

int open_at(int folder, const char* path, int flags, std::va_list list) {
    const bool makes = (flags & (O_CREAT | O_TMPFILE)) != 0;
    const long mode = makes ? static_cast<long>(va_arg(list, mode_t)) : 0;
    return static_cast<int>(host_call(SYS_openat, folder, number_of(path), flags, mode));
}

int raw_open(const char* path, int flags, ...) {
    std::va_list list;
    va_start(list, flags);
    const int fd = open_at(AT_FDCWD, path, flags, list);
    va_end(list);
    return fd;
}

int raw_openat(int folder, const char* path, int flags, ...) {
    std::va_list list;
    va_start(list, flags);
    const int fd = open_at(folder, path, flags, list);
    va_end(list);
    return fd;
}

ssize_t raw_read(int fd, void* buffer, size_t size) {
    return host_call(SYS_read, fd, number_of(buffer), static_cast<long>(size));
}

ssize_t raw_write(int fd, const void* data, size_t size) {
    return host_call(SYS_write, fd, number_of(data), static_cast<long>(size));
}

off_t raw_lseek(int fd, off_t offset, int from) {
    return host_call(SYS_lseek, fd, offset, from);
}

int raw_close(int fd) {
    return static_cast<int>(host_call(SYS_close, fd));
}

int raw_dup(int fd) {
    return static_cast<int>(host_call(SYS_dup, fd));
}

int raw_dup3(int fd, int copy, int flags) {
    return static_cast<int>(host_call(SYS_dup3, fd, copy, flags));
}

int raw_dup2(int fd, int copy) {
    if (fd != copy) return raw_dup3(fd, copy, 0);
    return host_call(SYS_fcntl, fd, F_GETFD) < 0 ? -1 : fd;
}

int raw_tcgetattr(int fd, termios* settings) {
    struct {
        tcflag_t c_iflag, c_oflag, c_cflag, c_lflag;
        cc_t c_line, c_cc[19];
    } kernel;
    if (host_call(SYS_ioctl, fd, TCGETS, number_of(&kernel)) < 0) return -1;
    std::memset(settings, 0, sizeof *settings);
    settings->c_iflag = kernel.c_iflag;
    settings->c_oflag = kernel.c_oflag;
    settings->c_cflag = kernel.c_cflag;
    settings->c_lflag = kernel.c_lflag;
    settings->c_line = kernel.c_line;
    std::memcpy(settings->c_cc, kernel.c_cc, sizeof kernel.c_cc);
    cfsetspeed(settings, kernel.c_cflag & CBAUD);
    return 0;
}

ssize_t raw_getdents64(int fd, void* entries, size_t room) {
    return host_call(SYS_getdents64, fd, number_of(entries), static_cast<long>(room));
}

DIR* raw_opendir(const char* path) {
    constexpr long kFlags = O_RDONLY | O_NONBLOCK | O_DIRECTORY | O_CLOEXEC;
    const int fd = static_cast<int>(host_call(SYS_openat, AT_FDCWD, number_of(path), kFlags));
    if (fd < 0) return nullptr;
    DIR* const folder = fdopendir(fd);
    if (folder == nullptr) {
        const int error = errno;
        host_call(SYS_close, fd);
        errno = error;
    }
    return folder;
}

// The kernel's struct is the C library's, of both names, on the processors that there is a library for.
static_assert(sizeof(struct stat) == sizeof(struct stat64));
int raw_fstatat(int folder, const char* path, struct stat* status, int flags) {
    return static_cast<int>(host_call(SYS_newfstatat, folder, number_of(path), number_of(status), flags));
}

int raw_stat(const char* path, struct stat* status) {
    return raw_fstatat(AT_FDCWD, path, status, 0);
}

int raw_lstat(const char* path, struct stat* status) {
    return raw_fstatat(AT_FDCWD, path, status, AT_SYMLINK_NOFOLLOW);
}

int raw_fstat(int fd, struct stat* status) {
    if (fd >= 0) return raw_fstatat(fd, "", status, AT_EMPTY_PATH);
    return fail(EBADF);
}

// Of programs that were linked with a C library older than 2.33.
int raw_xstat(int, const char* path, struct stat* status) {
    return raw_stat(path, status);
}

int raw_lxstat(int, const char* path, struct stat* status) {
    return raw_lstat(path, status);
}

int raw_fxstat(int, int fd, struct stat* status) {
    return raw_fstat(fd, status);
}

struct Raw {
    const char* name;
    void* function;
};
template <typename Function>
void* address(Function* function) {
    return reinterpret_cast<void*>(function);
}
}  // namespace

void* raw_function(const char* name) {
    const Raw list[] = {
        {"open", address(raw_open)},           {"open64", address(raw_open)},
        {"openat", address(raw_openat)},       {"openat64", address(raw_openat)},
        {"read", address(raw_read)},           {"write", address(raw_write)},
        {"lseek", address(raw_lseek)},         {"lseek64", address(raw_lseek)},
        {"close", address(raw_close)},         {"dup", address(raw_dup)},
        {"dup2", address(raw_dup2)},           {"dup3", address(raw_dup3)},
        {"tcgetattr", address(raw_tcgetattr)}, {"getdents64", address(raw_getdents64)},
        {"opendir", address(raw_opendir)},     {"stat", address(raw_stat)},
        {"stat64", address(raw_stat)},         {"lstat", address(raw_lstat)},
        {"lstat64", address(raw_lstat)},       {"fstat", address(raw_fstat)},
        {"fstat64", address(raw_fstat)},       {"fstatat", address(raw_fstatat)},
        {"fstatat64", address(raw_fstatat)},   {"__xstat", address(raw_xstat)},
        {"__xstat64", address(raw_xstat)},     {"__lxstat", address(raw_lxstat)},
        {"__lxstat64", address(raw_lxstat)},   {"__fxstat", address(raw_fxstat)},
        {"__fxstat64", address(raw_fxstat)},
    };
    for (const Raw& raw : list)
        if (std::strcmp(raw.name, name) == 0) return raw.function;
    return nullptr;
}

}  // namespace puckloop::shim
