// exec(): the program that follows in this process goes on in simulated time, with the devices and the alarms
// of the one before it.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/inheritance.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/wire/program_kind.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
/// Why `file` cannot be conducted, or nullptr. What cannot be executed at all is left to the host.
const char* obstacle(const char* file, int depth) {
    const int fd = REAL(open)(file, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return nullptr;
    struct stat status {};
    REAL(fstat)(fd, &status);
    const char* found = wire::obstacle_of_elf(fd, status).why;
    char head[256] = {};
    if (found == nullptr && depth < wire::kDeepestScript && pread(fd, head, sizeof head - 1, 0) > 2 &&
        head[0] == '#' && head[1] == '!') {
        char* word = head + 2 + std::strspn(head + 2, " \t");
        word[std::strcspn(word, " \t\n")] = '\0';
        found = obstacle(word, depth + 1);
    }
    REAL(close)(fd);
    return found;
}

/// This library's own file.
const char* own_file() {
    static Dl_info info{};
    if (info.dli_fname == nullptr) dladdr(reinterpret_cast<void*>(&own_file), &info);
    return info.dli_fname;
}

bool lists(const char* libraries, const char* file) {
    const std::size_t length = std::strlen(file);
    for (const char* item = libraries; *item != '\0';) {
        const std::size_t size = std::strcspn(item, ": ");
        if (size == length && std::strncmp(item, file, size) == 0) return true;
        item += size + (item[size] != '\0' ? 1 : 0);
    }
    return false;
}

/// A list of texts with an end; none at all is an empty one.
bool is_list(char* const* texts) {
    char* text = nullptr;
    for (; texts != nullptr; ++texts) {
        if (!get_from_program(text, texts)) return false;
        if (text == nullptr) return true;
        if (readable_bytes(text, 1) == 0) return false;
    }
    return true;
}

int run_program(const char* path, char* const* arguments, char* const* environment) {
    if (!active()) return REAL(execve)(path, arguments, environment);
    mark_call("execve");
    charge(page().charges.thread);
    if (!is_text(path) || !is_list(environment)) return fail(EFAULT);
    can_be_conducted(path, false);
    const std::string left = leave(true);
    wire::Request request;
    request.op = wire::Op::Exec;
    device_call(request, left.data(), left.size());
    char** linked = linked_environment(environment, own_slot());
    REAL(execve)(path, arguments, linked);
    const int error = errno;
    free(linked);
    return fail(error);
}

int run_found(const char* file, char* const* arguments, char* const* environment) {
    char room[PATH_MAX];
    if (!is_text(file)) return fail(EFAULT);
    const char* path = search_path(file, room);
    const int result = run_program(path, arguments, environment);
    if (errno != ENOEXEC) return result;
    std::vector<char*> words{const_cast<char*>("/bin/sh"), const_cast<char*>(path)};
    for (char* const* word = arguments; *word != nullptr && *++word != nullptr;)
        words.push_back(*word);
    words.push_back(nullptr);
    return run_program("/bin/sh", words.data(), environment);
}

/// The arguments of execl() and its kin.
std::vector<char*> gather(const char* first, std::va_list list) {
    std::vector<char*> words{const_cast<char*>(first)};
    while (words.back() != nullptr)
        words.push_back(va_arg(list, char*));
    return words;
}
}  // namespace

bool can_be_conducted(const char* file, bool spawned) {
    const char* why = obstacle(file, 0);
    if (why == nullptr) return true;
    char text[300];
    std::snprintf(text, sizeof text, "%s is not run: it is %s", file, why);
    note("%s", text);
    if (!spawned) {
        announce_exit(wire::kRefusedStatus);
        refuse(text);
    }
    host_complain("puckloop shim: ");
    host_complain(text);
    host_complain("\n");
    return false;
}

char** linked_environment(char* const* environment, std::uint32_t slot) {
    std::string link = std::string(wire::kLinkVariable) + "=";
    char place[64];
    print_link(place, sizeof place, slot);
    link += place;
    std::string preload = std::string("LD_PRELOAD=") + own_file();
    std::vector<char*> kept;
    for (char* const* entry = environment; entry != nullptr && *entry != nullptr; ++entry) {
        const std::size_t name = std::strcspn(*entry, "=");
        if (std::strncmp(*entry, wire::kLinkVariable, name) == 0 && name == std::strlen(wire::kLinkVariable))
            continue;
        if (std::strncmp(*entry, "LD_PRELOAD=", 11) != 0) {
            kept.push_back(*entry);
        } else if (lists(*entry + 11, own_file())) {
            preload = *entry;
        } else if ((*entry)[11] != '\0') {
            preload += std::string(":") + (*entry + 11);
        }
    }
    // One piece of memory, so that it is easily given back: the pointers, then the two texts.
    const std::size_t pointers = (kept.size() + 3) * sizeof(char*);
    auto* block = static_cast<char*>(malloc(pointers + preload.size() + link.size() + 2));
    auto** list = reinterpret_cast<char**>(block);
    std::copy(kept.begin(), kept.end(), list);
    list[kept.size()] = std::strcpy(block + pointers, preload.c_str());
    list[kept.size() + 1] = std::strcpy(block + pointers + preload.size() + 1, link.c_str());
    list[kept.size() + 2] = nullptr;
    return list;
}

const char* search_path(const char* file, char* room) {
    if (std::strchr(file, '/') != nullptr) return file;
    const char* path = getenv("PATH");
    for (const char* folder = path != nullptr ? path : "/bin:/usr/bin"; folder != nullptr;) {
        const std::size_t size = std::strcspn(folder, ":");
        std::snprintf(room, PATH_MAX, "%.*s%s%s", static_cast<int>(size), folder, size != 0 ? "/" : "./",
                      file);
        struct stat status {};
        if (REAL(stat)(room, &status) == 0 && S_ISREG(status.st_mode) && REAL(access)(room, X_OK) == 0)
            return room;
        folder = folder[size] == ':' ? folder + size + 1 : nullptr;
    }
    return file;
}

}  // namespace puckloop::shim

SHIM_EXPORT int execve(const char* path, char* const* arguments, char* const* environment) noexcept {
    return run_program(path, arguments, environment);
}

SHIM_EXPORT int execv(const char* path, char* const* arguments) noexcept {
    return run_program(path, arguments, environ);
}

SHIM_EXPORT int execvpe(const char* file, char* const* arguments, char* const* environment) noexcept {
    return run_found(file, arguments, environment);
}

SHIM_EXPORT int execvp(const char* file, char* const* arguments) noexcept {
    return run_found(file, arguments, environ);
}

SHIM_EXPORT int fexecve(int fd, char* const* arguments, char* const* environment) noexcept {
    if (!active()) return REAL(fexecve)(fd, arguments, environment);
    char path[40];
    std::snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    return run_program(path, arguments, environment);
}

SHIM_EXPORT int execveat(int folder, const char* path, char* const* arguments, char* const* environment,
                         int flags) noexcept {
    if (!active()) return REAL(execveat)(folder, path, arguments, environment, flags);
    if (!is_text(path)) return fail(EFAULT);
    if (*path == '\0' && (flags & AT_EMPTY_PATH) != 0) return fexecve(folder, arguments, environment);
    if (*path == '/' || folder == AT_FDCWD) return run_program(path, arguments, environment);
    char beside[512];
    const int size = std::snprintf(beside, sizeof beside, "/proc/self/fd/%d/%s", folder, path);
    if (size < static_cast<int>(sizeof beside)) return run_program(beside, arguments, environment);
    return fail(ENAMETOOLONG);
}

SHIM_EXPORT int execl(const char* path, const char* first, ...) noexcept {
    std::va_list list;
    va_start(list, first);
    const std::vector<char*> words = gather(first, list);
    va_end(list);
    return run_program(path, words.data(), environ);
}

SHIM_EXPORT int execlp(const char* file, const char* first, ...) noexcept {
    std::va_list list;
    va_start(list, first);
    const std::vector<char*> words = gather(first, list);
    va_end(list);
    return run_found(file, words.data(), environ);
}

SHIM_EXPORT int execle(const char* path, const char* first, ...) noexcept {
    std::va_list list;
    va_start(list, first);
    const std::vector<char*> words = gather(first, list);
    char* const* environment = va_arg(list, char* const*);
    va_end(list);
    return run_program(path, words.data(), environment);
}
