// Open files that a process passes to another one over a socket of the host: SCM_RIGHTS.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sys/stat.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstring>

namespace puckloop::shim {

namespace {

/// Calls `act` with each descriptor in the control data.
template <typename Act>
void for_each_descriptor(const msghdr& message, Act act) {
    auto& writable = const_cast<msghdr&>(message);
    for (cmsghdr* part = CMSG_FIRSTHDR(&writable); part != nullptr; part = CMSG_NXTHDR(&writable, part)) {
        if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
        const std::size_t size = part->cmsg_len - CMSG_LEN(0);
        for (std::size_t at = 0; at + sizeof(int) <= size; at += sizeof(int)) {
            int fd = -1;
            std::memcpy(&fd, CMSG_DATA(part) + at, sizeof fd);
            act(fd);
        }
    }
}

/// Of the host's socket behind a descriptor; 0 for what is none.
std::uint64_t inode_of(int fd) {
    struct stat status {};
    if (host_call(SYS_fstat, fd, reinterpret_cast<long>(&status), 0, 0) != 0) return 0;
    return S_ISSOCK(status.st_mode) ? status.st_ino : 0;
}

}  // namespace

void give_descriptors(const msghdr& message) {
    for_each_descriptor(message, [](int fd) {
        const OpenFile* file = open_file(fd);
        if (file == nullptr) return;
        if (file->kind != OpenFile::Kind::Socket) {
            note("a device was passed to another process, which gets none");
            return;
        }
        const wire::PassedFile passed{inode_of(fd), file->flags, file->netlink ? 2u : file->stream ? 1u : 0u};
        device_call(device_request(*file, wire::Op::Give), &passed, sizeof passed);
    });
}

void forget_given(const msghdr& message) {
    const int error = errno;
    for_each_descriptor(message, [](int fd) {
        const wire::PassedFile passed{inode_of(fd), 0, 0};
        if (open_file(fd) == nullptr || passed.inode == 0) return;
        wire::Request request;
        request.op = wire::Op::Take;
        device_call(request, &passed, sizeof passed);
    });
    errno = error;
}

void take_descriptors(msghdr& message) {
    for_each_descriptor(message, [](int fd) {
        wire::PassedFile passed{inode_of(fd), 0, 0};
        if (passed.inode == 0) return;
        wire::Request request;
        request.op = wire::Op::Take;
        const auto handle =
            static_cast<int>(device_call(request, &passed, sizeof passed, &passed, sizeof passed));
        if (handle < 0) return;
        if (const int same = descriptor_of(handle); same >= 0) {
            share_file(same, fd);
            return;
        }
        OpenFile* const file = adopt_descriptor(fd);
        if (file == nullptr) return;
        file->kind = OpenFile::Kind::Socket;
        file->path = kSocketPath;
        file->handle = handle;
        file->stream = passed.kind == 1;
        file->netlink = passed.kind == 2;
        file->flags = passed.flags;
    });
}

}  // namespace puckloop::shim
