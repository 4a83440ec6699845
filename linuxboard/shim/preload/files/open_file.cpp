#include "linuxboard/shim/preload/files/open_file.h"

#include "base/random.h"
#include "linuxboard/shim/preload/host.h"
#include "linuxboard/shim/preload/real.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace puckloop::shim {

namespace {
constexpr int kMostDescriptors = 4096;
OpenFile* table[kMostDescriptors];
constexpr const char* kRandomPaths[] = {"/dev/urandom", "/dev/random"};
constexpr std::size_t kMostTransferData = wire::kMaximumData - 1024;
}  // namespace

/// The device's name in this program's own view of the page.
static const char* path_of(const OpenFile& file) {
    return file.device >= 0 ? page().devices[file.device].path : "";
}

OpenFile* open_file(int fd) {
    if (fd < 0 || fd >= kMostDescriptors || table[fd] == nullptr || !active()) return nullptr;
    return table[fd];
}

int device_of(const char* path) {
    if (path == nullptr || !is_linked()) return kNoDevice;
    for (const char* random : kRandomPaths) {
        if (std::strcmp(path, random) == 0) return active() ? kRandomDevice : kNoDevice;
    }
    for (std::uint32_t i = 0; i < wire::kMaximumDevices; ++i) {
        const wire::DeviceName& device = page().devices[i];
        if (device.kind != wire::DeviceKind::None && std::strcmp(path, device.path) == 0)
            return active() ? static_cast<int>(i) : kForbiddenDevice;
    }
    return kNoDevice;
}

int open_device(int device, int flags) {
    if (device == kForbiddenDevice) {
        host_complain("puckloop shim: a thread that was not made by pthread_create() has no devices\n");
        errno = ENXIO;
        return -1;
    }
    mark_call("open");
    const int fd = REAL(open)("/dev/null", O_RDWR | (flags & O_CLOEXEC));
    if (fd < 0) return fd;
    if (fd >= kMostDescriptors) {
        REAL(close)(fd);
        errno = EMFILE;
        return -1;
    }
    auto* file = new OpenFile;
    file->flags = flags & (O_ACCMODE | O_NONBLOCK);
    if (device == kRandomDevice) {
        file->kind = OpenFile::Kind::Random;
        file->path = kRandomPaths[0];
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
            errno = error;
            return -1;
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
            file->path = file->kind == OpenFile::Kind::Random ? kRandomPaths[0] : path_of(*file);
        } else {
            file = table[list[i].same_as];
        }
        ++file->references;
    }
    for (std::size_t i = 0; i < count; ++i)
        if (REAL(fcntl)(list[i].fd, F_GETFD) < 0) release_file(list[i].fd);
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

std::int64_t read_device(OpenFile& file, void* buffer, std::size_t size) {
    mark_call("read");
    pthread_testcancel();
    if (file.kind == OpenFile::Kind::Random) {
        random_bytes(buffer, size);
        return static_cast<std::int64_t>(size);
    }
    charge(page().charges.device);
    if ((file.flags & O_ACCMODE) == O_WRONLY) {
        errno = EBADF;
        return -1;
    }
    if (file.kind == OpenFile::Kind::I2c) {
        const auto length = static_cast<__u16>(std::min<std::size_t>(size, 8192));
        i2c_msg message{file.slave, I2C_M_RD, length, static_cast<__u8*>(buffer)};
        return transfer(file, &message, 1) == 1 ? length : -1;
    }
    if (file.kind == OpenFile::Kind::Video) return read_video(file, buffer, size);
    wire::Request request;
    request.op = wire::Op::Read;
    request.handle = file.handle;
    request.a = static_cast<std::uint32_t>(std::min<std::size_t>(size, wire::kMaximumData));
    request.nonblocking = (file.flags & O_NONBLOCK) != 0;
    return device_call(request, nullptr, 0, buffer, size, true);
}

std::int64_t write_device(OpenFile& file, const void* data, std::size_t size) {
    mark_call("write");
    pthread_testcancel();
    if (file.kind == OpenFile::Kind::Random) return static_cast<std::int64_t>(size);
    charge(page().charges.device);
    if ((file.flags & O_ACCMODE) == O_RDONLY) {
        errno = EBADF;
        return -1;
    }
    if (file.kind == OpenFile::Kind::I2c) {
        const auto length = static_cast<__u16>(std::min<std::size_t>(size, 8192));
        i2c_msg message{file.slave, 0, length, static_cast<__u8*>(const_cast<void*>(data))};
        return transfer(file, &message, 1) == 1 ? length : -1;
    }
    if (file.kind == OpenFile::Kind::Video) {
        errno = EINVAL;  // a capture device takes none
        return -1;
    }
    std::int64_t written = 0;
    const char* bytes = static_cast<const char*>(data);
    while (true) {
        const std::size_t part = std::min<std::size_t>(size, wire::kMaximumData);
        wire::Request request;
        request.op = wire::Op::Write;
        request.handle = file.handle;
        request.nonblocking = (file.flags & O_NONBLOCK) != 0;
        const std::int64_t result = device_call(request, bytes, part, nullptr, 0, true);
        if (result < 0) return written > 0 ? written : result;
        written += result;
        bytes += result;
        size -= static_cast<std::size_t>(result);
        if (size == 0 || static_cast<std::size_t>(result) < part) return written;
    }
}

int transfer(OpenFile& file, void* messages, unsigned count) {
    const auto* list = static_cast<const i2c_msg*>(messages);
    static char data[wire::kMaximumData];
    std::size_t size = 0;
    std::size_t to_read = 0;
    for (unsigned i = 0; i < count; ++i) {
        const i2c_msg& message = list[i];
        const bool reads = (message.flags & I2C_M_RD) != 0;
        constexpr int kKnownFlags = I2C_M_RD | I2C_M_RECV_LEN;
        if ((message.flags & ~kKnownFlags) != 0) {
            note("%s: I2C message flags 0x%x are not supported", file.path, message.flags);
            errno = EOPNOTSUPP;
            return -1;
        }
        const std::size_t more = sizeof(wire::I2cSegment) + (reads ? 0 : message.len);
        to_read += reads ? message.len : 0;
        if (size + more > kMostTransferData || to_read > kMostTransferData) {
            note("%s: an I2C transfer of more than %zu bytes is not supported", file.path, kMostTransferData);
            errno = EOPNOTSUPP;
            return -1;
        }
        const wire::I2cSegment segment{message.addr, message.flags, message.len};
        std::memcpy(data + size, &segment, sizeof segment);
        size += sizeof segment;
        if (!reads && message.len > 0) {
            std::memcpy(data + size, message.buf, message.len);
            size += message.len;
        }
    }
    wire::Request request;
    request.op = wire::Op::Transfer;
    request.handle = file.handle;
    request.a = file.timeout_ms;
    request.b = count;
    auto* answer = static_cast<char*>(__builtin_alloca(to_read + 64));
    std::size_t received = 0;
    const auto done =
        static_cast<int>(device_call(request, data, size, answer, to_read + 64, false, &received));
    if (done < 0) return -1;
    std::size_t used = 0;
    for (unsigned i = 0; i < count; ++i) {
        const i2c_msg& message = list[i];
        if ((message.flags & I2C_M_RD) == 0 || message.len == 0) continue;
        std::size_t length = message.len;
        if ((message.flags & I2C_M_RECV_LEN) != 0 && used < received)
            length += static_cast<unsigned char>(answer[used]);
        length = std::min(length, received - used);
        std::memcpy(message.buf, answer + used, length);
        used += length;
    }
    return done;
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

}  // namespace puckloop::shim
