#include "linuxboard/shim/preload/descriptors/process_paths.h"

#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

ProcessPath::ProcessPath(const char* path) : path_(path) {
    constexpr char kFolder[] = "/proc/";
    constexpr std::size_t kSize = sizeof kFolder - 1;
    if (!active() || !is_text(path) || std::strncmp(path, kFolder, kSize) != 0) return;
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

SHIM_EXPORT ssize_t readlink(const char* path, char* text, size_t size) noexcept {
    return REAL(readlink)(ProcessPath(path), text, size);
}
SHIM_EXPORT ssize_t readlinkat(int folder, const char* path, char* text, size_t size) noexcept {
    return REAL(readlinkat)(folder, ProcessPath(path), text, size);
}
SHIM_EXPORT DIR* opendir(const char* path) {
    return REAL(opendir)(ProcessPath(path));
}
SHIM_EXPORT int chdir(const char* path) noexcept {
    return REAL(chdir)(ProcessPath(path));
}
