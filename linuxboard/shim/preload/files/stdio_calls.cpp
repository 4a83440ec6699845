// Devices opened as streams. The C library's streams make their own system calls, so a device gets a stream
// whose reading and writing come back here; so does a pipe, in which a process may wait for another one.

#include "linuxboard/shim/preload/calls.h"
#include "linuxboard/shim/preload/files/open_file.h"
#include "linuxboard/shim/preload/files/video_names.h"
#include "linuxboard/shim/preload/real.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>

using namespace puckloop::shim;

extern "C" {
int __dprintf_chk(int, int, const char*, ...);
int __vdprintf_chk(int, int, const char*, std::va_list);
}

namespace {
constexpr int kMostStreams = 64;
struct Stream {
    FILE* file = nullptr;
    int fd = -1;
};
Stream streams[kMostStreams];

int descriptor(void* cookie) {
    return static_cast<int>(reinterpret_cast<std::intptr_t>(cookie));
}

int flags_of(const char* mode) {
    int flags = std::strchr(mode, '+') != nullptr ? O_RDWR : mode[0] == 'r' ? O_RDONLY : O_WRONLY;
    if (std::strchr(mode, 'e') != nullptr) flags |= O_CLOEXEC;
    return flags;
}

}  // namespace

namespace puckloop::shim {

bool is_channel(int fd) {
    struct stat status {};
    if (!active() || REAL(fstat)(fd, &status) != 0) return false;
    return S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode);
}

FILE* open_stream(int fd, const char* mode) {
    if (fd < 0) return nullptr;
    cookie_io_functions_t calls{};
    calls.read = [](void* cookie, char* buffer, size_t size) -> ssize_t {
        return read(descriptor(cookie), buffer, size);
    };
    calls.write = [](void* cookie, const char* data, size_t size) -> ssize_t {
        const ssize_t written = write(descriptor(cookie), data, size);
        return written < 0 ? 0 : written;
    };
    calls.close = [](void* cookie) {
        const int own = descriptor(cookie);
        for (Stream& stream : streams) {
            if (stream.fd == own) stream = {};
        }
        return close(own);
    };
    FILE* file = fopencookie(reinterpret_cast<void*>(static_cast<std::intptr_t>(fd)), mode, calls);
    if (file == nullptr) return nullptr;
    for (Stream& stream : streams) {
        if (stream.file != nullptr) continue;
        stream = {file, fd};
        break;
    }
    const OpenFile* device = open_file(fd);
    if (device != nullptr && device->kind == OpenFile::Kind::Tty) setvbuf(file, nullptr, _IOLBF, BUFSIZ);
    return file;
}

void adopt_standard_streams() {
    if (is_channel(STDIN_FILENO)) stdin = open_stream(STDIN_FILENO, "r");
    if (is_channel(STDOUT_FILENO)) {
        stdout = open_stream(STDOUT_FILENO, "w");
        const char* asked = getenv("_STDBUF_O");  // stdbuf's own library has set up the stream before
        const bool unbuffered = asked != nullptr && strcmp(asked, "0") == 0;
        setvbuf(stdout, nullptr, unbuffered ? _IONBF : _IOLBF, BUFSIZ);
    }
    if (is_channel(STDERR_FILENO)) {
        stderr = open_stream(STDERR_FILENO, "w");
        setvbuf(stderr, nullptr, _IONBF, 0);
    }
}

}  // namespace puckloop::shim

namespace {

int print(int fd, const char* format, std::va_list arguments) {
    char* text = nullptr;
    const int length = vasprintf(&text, format, arguments);
    if (length < 0) return -1;
    const ssize_t written = write(fd, text, static_cast<size_t>(length));
    free(text);
    return static_cast<int>(written);
}
}  // namespace

SHIM_EXPORT FILE* fopen(const char* path, const char* mode) {
    const int device = device_of(path);
    if (const int uevent = open_video_uevent(path); uevent >= 0) return REAL(fdopen)(uevent, mode);
    if (device == kNoDevice && is_named_pipe(path)) return open_stream(open(path, flags_of(mode)), mode);
    return device == kNoDevice ? REAL(fopen)(path, mode)
                               : open_stream(open_device(device, flags_of(mode)), mode);
}

SHIM_EXPORT FILE* fopen64(const char* path, const char* mode) {
    const int device = device_of(path);
    if (const int uevent = open_video_uevent(path); uevent >= 0) return REAL(fdopen)(uevent, mode);
    if (device == kNoDevice && is_named_pipe(path)) return open_stream(open(path, flags_of(mode)), mode);
    return device == kNoDevice ? REAL(fopen64)(path, mode)
                               : open_stream(open_device(device, flags_of(mode)), mode);
}

SHIM_EXPORT FILE* fdopen(int fd, const char* mode) noexcept {
    return open_file(fd) == nullptr && !is_channel(fd) ? REAL(fdopen)(fd, mode) : open_stream(fd, mode);
}

SHIM_EXPORT int fileno(FILE* file) noexcept {
    for (const Stream& stream : streams) {
        if (file != nullptr && stream.file == file) return stream.fd;
    }
    return REAL(fileno)(file);
}

SHIM_EXPORT int fileno_unlocked(FILE* file) noexcept {
    return fileno(file);
}

SHIM_EXPORT int vdprintf(int fd, const char* format, std::va_list arguments) {
    return open_file(fd) == nullptr && !is_channel(fd) ? REAL(vdprintf)(fd, format, arguments)
                                                       : print(fd, format, arguments);
}

SHIM_EXPORT int dprintf(int fd, const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    const int result = vdprintf(fd, format, arguments);
    va_end(arguments);
    return result;
}

SHIM_EXPORT int __vdprintf_chk(int fd, int, const char* format, std::va_list arguments) {
    return vdprintf(fd, format, arguments);
}

SHIM_EXPORT int __dprintf_chk(int fd, int, const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    const int result = vdprintf(fd, format, arguments);
    va_end(arguments);
    return result;
}
