#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"

#include "base/random.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace puckloop::shim {

namespace {
OpenFile* table[kMostDescriptors];
constexpr const char* kRandomPath = "/dev/urandom";
/// What F_GETFL shows of the flags that open() takes.
constexpr int kKeptFlags = O_ACCMODE | O_NONBLOCK | O_APPEND | O_SYNC | O_NOATIME;
/// The tty layer takes what is written in pieces of so many bytes.
constexpr std::size_t kTtyChunk = 2048;

/// What the kernel checks of every buffer before it does anything: that it can be the program's at all.
bool is_user_range(const void* buffer, std::size_t size) {
    constexpr std::uintptr_t kEnd = std::uintptr_t{1} << 47;
    const auto begin = reinterpret_cast<std::uintptr_t>(buffer);
    if (begin <= kEnd && size <= kEnd - begin) return true;
    errno = EFAULT;
    return false;
}

}  // namespace

/// The device's name in this program's own view of the page.
static const char* path_of(const OpenFile& file) {
    return file.device >= 0 ? page().devices[file.device].path : "";
}

OpenFile* open_file(int fd) {
    if (fd < 0 || fd >= kMostDescriptors || table[fd] == nullptr || !active()) return nullptr;
    return table[fd];
}

OpenFile* adopt_descriptor(int fd) {
    if (fd >= kMostDescriptors) {
        REAL(close)(fd);
        errno = EMFILE;
        return nullptr;
    }
    release_file(fd);
    table[fd] = new OpenFile;
    table[fd]->references = 1;
    return table[fd];
}

int open_device(int device, int flags) {
    if (device == kForbiddenDevice) {
        host_complain("puckloop shim: a thread that was not made by pthread_create() has no devices\n");
        return fail(ENXIO);
    }
    mark_call("open");
    const int refused = (flags & O_DIRECTORY) != 0                           ? ENOTDIR
                        : (flags & (O_CREAT | O_EXCL)) == (O_CREAT | O_EXCL) ? EEXIST
                        : (flags & O_DIRECT) != 0 && device != kRandomDevice ? EINVAL
                                                                             : 0;
    if (refused != 0) return fail(refused);
    const int fd = REAL(open)("/dev/null", flags & (O_ACCMODE | O_CLOEXEC | O_PATH));
    if (fd < 0 || (flags & O_PATH) != 0) return fd;  // a path only: nothing is opened
    if (fd >= kMostDescriptors) {
        REAL(close)(fd);
        return fail(EMFILE);
    }
    auto* file = new OpenFile;
    file->flags = flags & kKeptFlags;
    if (device == kRandomDevice) {
        file->kind = OpenFile::Kind::Random;
        file->path = kRandomPath;
    } else {
        const wire::DeviceName& name = page().devices[device];
        file->kind = name.kind == wire::DeviceKind::Tty   ? OpenFile::Kind::Tty
                     : name.kind == wire::DeviceKind::I2c ? OpenFile::Kind::I2c
                                                          : OpenFile::Kind::Video;
        file->path = name.path;
        file->device = device;
        charge(page().charges.device);
        wire::Request request;
        request.op = wire::Op::Open;
        request.a = static_cast<std::uint32_t>(device);
        file->handle = static_cast<int>(device_call(request));
        if (file->handle < 0) {
            const int error = errno;
            delete file;
            REAL(close)(fd);
            return fail(error);
        }
    }
    file->references = 1;
    table[fd] = file;
    return fd;
}

std::size_t open_files(FileEntry* list, std::size_t most) {
    std::size_t count = 0;
    for (int fd = 0; fd < kMostDescriptors && count < most; ++fd) {
        if (table[fd] == nullptr) continue;
        int first = fd;
        for (int other = 0; other < fd && first == fd; ++other)
            if (table[other] == table[fd]) first = other;
        list[count++] = {fd, first, *table[fd]};
    }
    return count;
}

void take_over_files(FileEntry* list, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        OpenFile*& file = table[list[i].fd];
        if (list[i].same_as == list[i].fd) {
            file = new OpenFile(list[i].file);
            file->references = 0;
            file->path = file->kind == OpenFile::Kind::Random   ? kRandomPath
                         : file->kind == OpenFile::Kind::Socket ? kSocketPath
                                                                : path_of(*file);
        } else {
            file = table[list[i].same_as];
        }
        ++file->references;
    }
    for (std::size_t i = 0; i < count; ++i)
        if (REAL(fcntl)(list[i].fd, F_GETFD) < 0) release_file(list[i].fd);
}

int descriptor_of(int handle) {
    for (int fd = 0; fd < kMostDescriptors; ++fd)
        if (table[fd] != nullptr && table[fd]->handle == handle) return fd;
    return -1;
}

void share_file(int from, int to) {
    if (to < 0 || to >= kMostDescriptors || from == to) return;
    release_file(to);
    if (from < 0 || from >= kMostDescriptors || table[from] == nullptr) return;
    table[to] = table[from];
    ++table[to]->references;
}

bool release_file(int fd) {
    if (fd < 0 || fd >= kMostDescriptors || table[fd] == nullptr) return false;
    OpenFile* file = table[fd];
    table[fd] = nullptr;
    drop_watches(fd);
    if (--file->references > 0) return true;
    if (file->handle >= 0 && active()) {
        charge(page().charges.device);
        wire::Request request;
        request.op = wire::Op::Close;
        request.handle = file->handle;
        device_call(request);
    }
    // Another thread may still be inside a call on this file: it is left alone.
    return true;
}

wire::Request device_request(const OpenFile& file, wire::Op op) {
    wire::Request request;
    request.op = op;
    request.handle = file.handle;
    request.nonblocking = (file.flags & O_NONBLOCK) != 0;
    return request;
}

std::int64_t read_device(OpenFile& file, void* buffer, std::size_t size) {
    mark_call("read");
    pthread_testcancel();
    if (file.kind == OpenFile::Kind::Random) return read_random(buffer, size);
    if (file.kind == OpenFile::Kind::Socket) return size == 0 ? 0 : read_socket(file, buffer, size, 0);
    charge(page().charges.device);
    if ((file.flags & O_ACCMODE) == O_WRONLY || (file.flags & O_ACCMODE) == O_ACCMODE) return fail(EBADF);
    if (!is_user_range(buffer, size)) return -1;
    if (file.kind == OpenFile::Kind::I2c) return read_i2c(file, buffer, size);
    if (file.kind == OpenFile::Kind::Video) return read_video(file, buffer, size);
    wire::Request request = device_request(file, wire::Op::Read);
    request.a = static_cast<std::uint32_t>(std::min<std::size_t>(size, wire::kMaximumData));
    return device_call(request, nullptr, 0, buffer, size, true);
}

std::int64_t write_device(OpenFile& file, const void* data, std::size_t size) {
    mark_call("write");
    pthread_testcancel();
    if (file.kind == OpenFile::Kind::Random) return static_cast<std::int64_t>(size);
    if (file.kind == OpenFile::Kind::Socket) return write_socket(file, data, size, 0);
    charge(page().charges.device);
    if ((file.flags & O_ACCMODE) == O_RDONLY || (file.flags & O_ACCMODE) == O_ACCMODE) return fail(EBADF);
    if (!is_user_range(data, size)) return -1;
    if (file.kind == OpenFile::Kind::I2c) return write_i2c(file, data, size);
    if (file.kind == OpenFile::Kind::Video) {
        return fail(EINVAL);  // a capture device takes none
    }
    if (size == 0) return 0;
    std::int64_t written = 0;
    const char* bytes = static_cast<const char*>(data);
    while (true) {
        std::size_t part = std::min<std::size_t>(size, wire::kMaximumData);
        const std::size_t there = readable_bytes(bytes, part);
        if (there < part) part = there / kTtyChunk * kTtyChunk;
        if (part == 0) {
            errno = EFAULT;
            return written > 0 ? written : -1;
        }
        const wire::Request request = device_request(file, wire::Op::Write);
        const std::int64_t result = device_call(request, bytes, part, nullptr, 0, true);
        if (result < 0) return written > 0 ? written : result;
        written += result;
        bytes += result;
        size -= static_cast<std::size_t>(result);
        if (size == 0 || static_cast<std::size_t>(result) < part) return written;
    }
}

const char* place_of(const void* address) {
    static char text[200];
    Dl_info info{};
    if (dladdr(address, &info) == 0 || info.dli_fname == nullptr) return "somewhere";
    const char* slash = std::strrchr(info.dli_fname, '/');
    const char* name = slash != nullptr ? slash + 1 : info.dli_fname;
    const auto offset = static_cast<const char*>(address) - static_cast<const char*>(info.dli_fbase);
    if (info.dli_sname != nullptr) {
        std::snprintf(text, sizeof text, "%s in %s", info.dli_sname, name);
    } else {
        std::snprintf(text, sizeof text, "%s+0x%lx", name, static_cast<unsigned long>(offset));
    }
    return text;
}

void random_bytes(void* buffer, std::size_t size) {
    // Each process of the program has a stream of its own; a forked child does not go on with its parent's.
    static RandomStream stream(page().seed, "linux program");
    static std::int32_t number = wire::kFirstProcess;
    if (own().number != number) {
        number = own().number;
        char name[40];
        std::snprintf(name, sizeof name, "linux program %d", number);
        stream = RandomStream(page().seed, name);
    }
    auto* out = static_cast<unsigned char*>(buffer);
    for (std::size_t i = 0; i < size; ++i)
        out[i] = static_cast<unsigned char>(stream.next() >> 56);
}

std::int64_t read_random(void* buffer, std::size_t size) {
    char* out = static_cast<char*>(buffer);
    std::size_t done = 0;
    while (done < size) {
        char part[256];
        const std::size_t more = std::min(size - done, sizeof part);
        random_bytes(part, more);
        if (!copy_to_program(out + done, part, more)) break;
        done += more;
    }
    if (done == 0 && size > 0) return -1;
    return static_cast<std::int64_t>(done);
}

}  // namespace puckloop::shim
