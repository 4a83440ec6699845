#include "linuxboard/shim/preload/descriptors/process_paths.h"

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

ProcessPath::ProcessPath(const char* path) : path_(path) {
    if (active() && is_text(path)) translate(path);
}

ProcessPath::ProcessPath(int folder, const char* path) : path_(path) {
    if (!active() || !is_text(path)) return;
    if (folder < 0 || path[0] < '0' || path[0] > '9') {
        translate(path);
        return;
    }
    char link[40], target[8];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    const int error = errno;
    const long size = host_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(link),
                                reinterpret_cast<long>(target), sizeof target);
    errno = error;
    char whole[sizeof room_];
    constexpr char kFolder[] = "/proc";
    if (size != sizeof kFolder - 1 || std::memcmp(target, kFolder, sizeof kFolder - 1) != 0) return;
    if (std::snprintf(whole, sizeof whole, "%s/%s", kFolder, path) < static_cast<int>(sizeof whole))
        translate(whole);
}

void ProcessPath::translate(const char* path) {
    constexpr char kFolder[] = "/proc/";
    constexpr std::size_t kSize = sizeof kFolder - 1;
    if (std::strncmp(path, kFolder, kSize) != 0) return;
    const char* const number = path + kSize;
    const std::size_t digits = std::strspn(number, "0123456789");
    if (digits == 0 || (number[digits] != '\0' && number[digits] != '/')) return;
    const int error = errno;
    const long given = std::strtol(number, nullptr, 10);
    const pid_t host = given > 0 && given <= INT_MAX ? host_process(static_cast<pid_t>(given)) : -1;
    errno = error;
    // No process has the number 0.
    const int size =
        std::snprintf(room_, sizeof room_, "%s%d%s", kFolder, std::max(host, 0), number + digits);
    path_ = size < static_cast<int>(sizeof room_) ? room_ : "/proc/0";
}

}  // namespace puckloop::shim

using namespace puckloop::shim;

extern "C" {
ssize_t __readlink_chk(const char*, char*, size_t, size_t) noexcept;
ssize_t __readlinkat_chk(int, const char*, char*, size_t, size_t) noexcept;
}

namespace {
/// Where a link of /proc leads on the board: the program's own process, and the device behind a descriptor.
/// False: `path` is no such link.
bool read_board_link(const char* path, char (&target)[80]) {
    if (!active() || !is_text(path) || path[0] != '/') return false;
    if (std::strcmp(path, "/proc/self") == 0) {
        std::snprintf(target, sizeof target, "%d", own().number);
    } else if (std::strcmp(path, "/proc/thread-self") == 0) {
        std::snprintf(target, sizeof target, "%d/task/%d", own().number, thread_number(self()->index));
    } else {
        const bool is_link = std::strncmp(path, "/dev/std", 8) == 0;  // to one of these
        const OpenFile* file = is_link ? nullptr : open_file(named_descriptor(path));
        if (file == nullptr) return false;
        if (file->kind == OpenFile::Kind::Socket) {
            std::snprintf(target, sizeof target, "socket:[%d]", file->handle);
        } else {
            std::snprintf(target, sizeof target, "%s", file->path);
        }
    }
    return true;
}
}  // namespace

SHIM_EXPORT ssize_t readlink(const char* path, char* text, size_t size) noexcept {
    char target[80];
    if (!read_board_link(path, target)) return REAL(readlink)(ProcessPath(path), text, size);
    const std::size_t length = std::min(size, std::strlen(target));
    return copy_to_program(text, target, length) ? static_cast<ssize_t>(length) : -1;
}
SHIM_EXPORT ssize_t readlinkat(int folder, const char* path, char* text, size_t size) noexcept {
    char target[80];
    if (read_board_link(path, target)) return readlink(path, text, size);
    return REAL(readlinkat)(folder, ProcessPath(folder, path), text, size);
}
SHIM_EXPORT ssize_t __readlink_chk(const char* path, char* text, size_t size, size_t room) noexcept {
    if (size > room) __builtin_trap();
    return readlink(path, text, size);
}
SHIM_EXPORT ssize_t __readlinkat_chk(int folder, const char* path, char* text, size_t size,
                                     size_t room) noexcept {
    if (size > room) __builtin_trap();
    return readlinkat(folder, path, text, size);
}
SHIM_EXPORT int chdir(const char* path) noexcept {
    return REAL(chdir)(ProcessPath(path));
}
