// Cameras: ioctl, read and mmap. The node is their driver; an ioctl's struct goes to it and comes back, the
// frames lie in memory that both share.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::shim {

namespace {

constexpr std::size_t kMostControls = 256;
constexpr std::size_t kMostIoctlData = sizeof(v4l2_ext_controls) + kMostControls * sizeof(v4l2_ext_control);

bool has_list(std::uint32_t request) {
    return request == VIDIOC_G_EXT_CTRLS || request == VIDIOC_S_EXT_CTRLS || request == VIDIOC_TRY_EXT_CTRLS;
}

}  // namespace

int video_ioctl(OpenFile& file, unsigned long number, void* argument) {
    const auto code = static_cast<std::uint32_t>(number);  // programs that take it for an int extend its sign
    char data[kMostIoctlData];
    const std::size_t size =
        std::min(_IOC_DIR(code) == _IOC_NONE ? 0 : std::size_t{_IOC_SIZE(code)}, sizeof data);
    if (!copy_from_program(data, argument, size)) return -1;
    std::size_t listed = 0;
    v4l2_ext_controls controls{};
    if (has_list(code)) {
        std::memcpy(&controls, data, sizeof controls);
        listed = std::min<std::size_t>(controls.count, kMostControls) * sizeof(v4l2_ext_control);
        listed = std::min(listed, sizeof data - size);
        if (!copy_from_program(data + size, controls.controls, listed)) return -1;
    }
    wire::Request request = device_request(file, wire::Op::Ioctl);
    request.a = code;
    const bool waits = code == VIDIOC_DQBUF && request.nonblocking == 0;
    std::size_t received = 0;
    const auto result =
        static_cast<int>(device_call(request, data, size + listed, data, sizeof data, waits, &received));
    const int error = errno;
    if (received < size) return result;  // a signal came first
    if (has_list(code)) {                // the program's own pointer stays
        controls.error_idx = reinterpret_cast<const v4l2_ext_controls*>(data)->error_idx;
        if (!put_to_program(argument, controls) || !copy_to_program(controls.controls, data + size, listed))
            return -1;
    } else if ((_IOC_DIR(code) & _IOC_READ) != 0 && !copy_to_program(argument, data, size)) {
        return -1;
    }
    errno = error;
    return result;
}

std::int64_t read_video(OpenFile& file, void* buffer, std::size_t size) {
    wire::Request request = device_request(file, wire::Op::VideoRead);
    request.a = static_cast<std::uint32_t>(std::min<std::size_t>(size, wire::kVideoBufferSize));
    std::uint64_t place = 0;
    const std::int64_t count = device_call(request, nullptr, 0, &place, sizeof place, true);
    if (count <= 0) return count;
    const std::uint64_t page_start = place / 4096 * 4096;
    const auto length = static_cast<std::size_t>(place - page_start) + static_cast<std::size_t>(count);
    void* frame = map_shared(nullptr, length, PROT_READ, MAP_SHARED, page_start);
    if (frame == MAP_FAILED) return -1;
    const bool copied = copy_to_program(buffer, static_cast<const char*>(frame) + (place - page_start),
                                        static_cast<std::size_t>(count));
    host_call(SYS_munmap, reinterpret_cast<long>(frame), static_cast<long>(length));
    return copied ? count : -1;
}

namespace {

/// A mapping of one of a camera's buffers.
void* map_video(const OpenFile& file, void* address, std::size_t length, int protection, int flags,
                off_t offset) {
    charge(page().charges.device);
    if (file.kind != OpenFile::Kind::Video) {
        errno = ENODEV;
        return MAP_FAILED;
    }
    const int sharing = flags & MAP_TYPE;
    if ((sharing != MAP_SHARED && sharing != MAP_SHARED_VALIDATE) || length == 0 || offset < 0 ||
        offset > UINT32_MAX || length > wire::kVideoBufferSize) {
        errno = EINVAL;
        return MAP_FAILED;
    }
    wire::Request request;
    request.op = wire::Op::Map;
    request.handle = file.handle;
    request.a = static_cast<std::uint32_t>(offset);
    request.b = static_cast<std::uint32_t>(length);
    const std::int64_t place = device_call(request);
    if (place < 0) return MAP_FAILED;
    return map_shared(address, length, protection, flags, static_cast<std::uint64_t>(place));
}

void* map(void* address, std::size_t length, int protection, int flags, int fd, off_t offset) {
    // The C library's own may be wanted before this library is ready: hence the plain system call.
    if ((flags & MAP_ANONYMOUS) == 0 && fd >= 0) {
        if (const OpenFile* file = open_file(fd)) {
            mark_call("mmap");
            return map_video(*file, address, length, protection, flags, offset);
        }
    }
    return reinterpret_cast<void*>(host_call(SYS_mmap, reinterpret_cast<long>(address),
                                             static_cast<long>(length), protection, flags, fd,
                                             static_cast<long>(offset)));
}

}  // namespace

}  // namespace puckloop::shim

SHIM_EXPORT void* mmap(void* address, size_t length, int protection, int flags, int fd,
                       off_t offset) noexcept {
    return puckloop::shim::map(address, length, protection, flags, fd, offset);
}

SHIM_EXPORT void* mmap64(void* address, size_t length, int protection, int flags, int fd,
                         off64_t offset) noexcept {
    return puckloop::shim::map(address, length, protection, flags, fd, offset);
}
