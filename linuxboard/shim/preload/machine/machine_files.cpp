// Files of /proc whose contents would be the host's, and other in each run: the board's, as of the moment at
// which they are opened.

#include "linuxboard/shim/preload/machine/machine_files.h"
#include "base/random.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/machine/machine_state.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

namespace {
constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr Time kTick = 10 * kMillisecond;  ///< USER_HZ is 100
constexpr std::size_t kRoom = 6000;

/// What a file holds; what has no room is left out.
class Text {
  public:
    __attribute__((format(printf, 2, 3))) void add(const char* format, ...) {
        std::va_list arguments;
        va_start(arguments, format);
        const int size = std::vsnprintf(room_ + size_, kRoom - size_, format, arguments);
        va_end(arguments);
        if (size > 0) size_ = std::min(size_ + static_cast<std::size_t>(size), kRoom - 1);
    }
    int open() const {
        const int fd = memfd_create("proc", MFD_CLOEXEC);
        if (fd < 0) return -1;
        if (REAL(write)(fd, room_, size_) == static_cast<ssize_t>(size_)) {
            lseek(fd, 0, SEEK_SET);
            return fd;
        }
        REAL(close)(fd);
        return -1;
    }

  private:
    char room_[kRoom];
    std::size_t size_ = 0;
};

Time computed_by_all() {
    Time computed = 0;
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free) computed += entry.computed;
    return computed;
}

pid_t last_process() {
    pid_t last = 0;
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free) last = std::max(last, entry.number);
    return last;
}

void write_uptime(Text& text) {
    const std::uint64_t up = up_nanoseconds();
    const std::uint64_t busy = static_cast<std::uint64_t>(computed_by_all() / kNanosecond);
    const std::uint64_t idle = up > busy ? up - busy : 0;
    constexpr std::uint64_t kHundredth = kNanosecondsPerSecond / 100;
    const auto whole = [](std::uint64_t time) {
        return static_cast<unsigned long>(time / kNanosecondsPerSecond);
    };
    const auto part = [](std::uint64_t time) { return static_cast<unsigned long>(time / kHundredth % 100); };
    text.add("%lu.%02lu %lu.%02lu\n", whole(up), part(up), whole(idle), part(idle));
}

void write_load(Text& text) {
    text.add("0.00 0.00 0.00 1/%u %d\n", processes_alive(), last_process());
}

void write_machine_stat(Text& text) {
    const Time busy = computed_by_all() / kTick;
    const Time up = static_cast<Time>(up_nanoseconds() / (kNanosecondsPerSecond / 100));
    for (const char* name : {"cpu ", "cpu0"})
        text.add("%s 0 0 %ld %ld 0 0 0 0 0 0\n", name, static_cast<long>(busy),
                 static_cast<long>(std::max<Time>(up - busy, 0)));
    text.add("intr 0\nctxt 0\nbtime %ld\nprocesses %d\nprocs_running 1\nprocs_blocked 0\nsoftirq 0\n",
             static_cast<long>((page().epoch - page().uptime) / static_cast<long>(kNanosecondsPerSecond)),
             last_process());
}

void write_memory(Text& text) {
    constexpr unsigned long kTotal = kBoardMemory / 1024, kFree = kTotal / 2;
    text.add("MemTotal:       %8lu kB\nMemFree:        %8lu kB\nMemAvailable:   %8lu kB\n", kTotal, kFree,
             kFree);
    for (const char* name : {"Buffers:", "Cached:", "SwapCached:", "Active:", "Inactive:", "SwapTotal:",
                             "SwapFree:", "Dirty:", "Shmem:", "Slab:", "SReclaimable:", "SUnreclaim:"})
        text.add("%-16s%8u kB\n", name, 0u);
}

void write_host_name(Text& text) {
    text.add("%s\n", page().host_name);
}

void write_uuid(Text& text, unsigned char (&bytes)[16]) {
    constexpr unsigned char kVersion = 0x40, kVariant = 0x80;  // RFC 9562, random
    bytes[6] = static_cast<unsigned char>((bytes[6] & 0x0f) | kVersion);
    bytes[8] = static_cast<unsigned char>((bytes[8] & 0x3f) | kVariant);
    for (int i = 0; i < 16; ++i)
        text.add("%s%02x", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", bytes[i]);
    text.add("\n");
}

void write_new_uuid(Text& text) {
    unsigned char bytes[16];
    random_bytes(bytes, sizeof bytes);
    write_uuid(text, bytes);
}

/// The same whenever it is asked for, also by another process.
void write_boot_id(Text& text) {
    RandomStream stream(page().seed, "boot_id");
    const std::uint64_t drawn[2] = {stream.next(), stream.next()};
    unsigned char bytes[16];
    std::memcpy(bytes, drawn, sizeof bytes);
    write_uuid(text, bytes);
}

struct MadeFile {
    const char* path;
    void (*write)(Text& text);
};
constexpr MadeFile kMadeFiles[] = {
    {"/proc/uptime", write_uptime},
    {"/proc/loadavg", write_load},
    {"/proc/stat", write_machine_stat},
    {"/proc/meminfo", write_memory},
    {"/proc/sys/kernel/hostname", write_host_name},
    {"/etc/hostname", write_host_name},
    {"/proc/sys/kernel/random/uuid", write_new_uuid},
    {"/proc/sys/kernel/random/boot_id", write_boot_id},
};

/// The process that `path` is about, and `rest` behind its folder; nullptr if it is none of the program's.
const wire::ProcessEntry* process_of(const char* path, const char*& rest) {
    constexpr char kFolder[] = "/proc/";
    if (std::strncmp(path, kFolder, sizeof kFolder - 1) != 0) return nullptr;
    path += sizeof kFolder - 1;
    for (const char* name : {"self/", "thread-self/"}) {
        if (std::strncmp(path, name, std::strlen(name)) != 0) continue;
        rest = path + std::strlen(name);
        return &own();
    }
    char* end = nullptr;
    const long number = *path >= '1' && *path <= '9' ? std::strtol(path, &end, 10) : 0;
    if (number == 0 || *end != '/') return nullptr;
    rest = end + 1;
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free && entry.number == number) return &entry;
    return nullptr;
}

/// The host's file about the process, as a text; its length, or -1.
long read_host_file(const wire::ProcessEntry& process, const char* name, char* out, std::size_t size) {
    char path[64];
    std::snprintf(path, sizeof path, "/proc/%d/%s", process.host, name);
    const long fd = host_call(SYS_openat, AT_FDCWD, reinterpret_cast<long>(path), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return -1;
    const long length = host_call(SYS_read, fd, reinterpret_cast<long>(out), static_cast<long>(size - 1));
    host_call(SYS_close, fd);
    if (length >= 0) out[length] = '\0';
    return length;
}

pid_t parent_of(const wire::ProcessEntry& process) {
    constexpr pid_t kInit = 1;
    return process.parent == wire::kNoParent ? kInit : page().processes[process.parent].number;
}

/// Deviation: what the kernel counts of memory, faults and signals is 0, the start is that of the board.
bool write_process_stat(Text& text, const wire::ProcessEntry& process) {
    char host[512];
    if (read_host_file(process, "stat", host, sizeof host) < 0) return false;
    const char* name = std::strchr(host, '(');
    const char* end = std::strrchr(host, ')');
    if (name == nullptr || end == nullptr) return false;
    const bool runs = &process == &own();
    const char state = process.state == wire::ProcessEntry::Ended ? 'Z' : runs ? 'R' : 'S';
    text.add("%d %.*s %c %d %d %d 0 -1 0 0 0 0 0", process.number, static_cast<int>(end - name + 1), name,
             state, parent_of(process), process.group, process.group);
    constexpr int kPriority = 20;
    text.add(" 0 %ld 0 %ld %d 0 %zu 0 %ld", static_cast<long>(process.computed / kTick),
             static_cast<long>(process.children_computed / kTick), kPriority, runs ? thread_count() : 1,
             static_cast<long>(page().uptime / static_cast<long>(kNanosecondsPerSecond / 100)));
    constexpr int kRest = 30;  // from vsize to exit_code
    for (int i = 0; i < kRest; ++i)
        text.add(" 0");
    text.add("\n");
    return true;
}

/// Numbers of processes are the program's; what the host counts of memory and switches is 0.
bool write_process_status(Text& text, const wire::ProcessEntry& process) {
    char host[4096];
    if (read_host_file(process, "status", host, sizeof host) < 0) return false;
    for (char* line = host; *line != '\0';) {
        char* end = std::strchr(line, '\n');
        if (end != nullptr) *end = '\0';
        const char* colon = std::strchr(line, ':');
        const auto size = colon != nullptr ? static_cast<std::size_t>(colon - line) : 0;
        const auto is = [&](const char* key) {
            return size == std::strlen(key) && std::strncmp(line, key, size) == 0;
        };
        if (is("Tgid") || is("Pid") || is("Ngid") || is("NStgid") || is("NSpid")) {
            text.add("%.*s:\t%d\n", static_cast<int>(size), line, is("Ngid") ? 0 : process.number);
        } else if (is("PPid")) {
            text.add("PPid:\t%d\n", parent_of(process));
        } else if (is("TracerPid")) {
            text.add("TracerPid:\t0\n");
        } else if (is("NSpgid") || is("NSsid")) {
            text.add("%.*s:\t%d\n", static_cast<int>(size), line, process.group);
        } else if (std::strncmp(line, "Vm", 2) == 0 || std::strncmp(line, "Rss", 3) == 0) {
            text.add("%.*s:\t%8d kB\n", static_cast<int>(size), line, 0);
        } else if (std::strstr(line, "ctxt_switches") != nullptr || is("SigQ")) {
            text.add("%.*s:\t0\n", static_cast<int>(size), line);
        } else {
            text.add("%s\n", line);
        }
        if (end == nullptr) break;
        line = end + 1;
    }
    return true;
}
}  // namespace

int open_machine_file(const char* path) {
    if (!active() || !is_text(path) || path[0] != '/') return -1;
    const int error = errno;
    Text text;
    bool made = false;
    for (const MadeFile& file : kMadeFiles) {
        if (std::strcmp(path, file.path) != 0) continue;
        file.write(text);
        made = true;
        break;
    }
    const char* rest = nullptr;
    if (!made && std::strncmp(path, "/proc/", 6) == 0) {
        const wire::ProcessEntry* process = process_of(path, rest);
        if (process != nullptr && std::strcmp(rest, "stat") == 0) made = write_process_stat(text, *process);
        if (process != nullptr && std::strcmp(rest, "status") == 0)
            made = write_process_status(text, *process);
    }
    errno = error;
    return made ? text.open() : -1;
}

}  // namespace puckloop::shim
