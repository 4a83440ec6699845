#include "linuxboard/shim/preload/host/raw_calls.h"

#include "linuxboard/shim/preload/host/host.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

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
        {"tcgetattr", address(raw_tcgetattr)},
    };
    for (const Raw& raw : list)
        if (std::strcmp(raw.name, name) == 0) return raw.function;
    return nullptr;
}

}  // namespace puckloop::shim
