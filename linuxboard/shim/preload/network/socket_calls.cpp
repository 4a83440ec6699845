// socket() and the calls that set a socket up.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/waiting/outside.h"

#include <fcntl.h>
#include <linux/netlink.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

using namespace puckloop::shim;

namespace puckloop::shim {

bool networked() {
    return active() && page().networked != 0;
}

OpenFile* socket_file(int fd) {
    OpenFile* file = open_file(fd);
    return file != nullptr && file->kind == OpenFile::Kind::Socket ? file : nullptr;
}

std::int64_t named(std::int64_t result, const wire::SocketAddress& address) {
    if (result >= 0) return result;
    const int error = errno;
    const std::uint32_t a = address.address;
    if (error == ENETUNREACH)
        note("the address %u.%u.%u.%u is outside of the network", a >> 24, a >> 16 & 0xff, a >> 8 & 0xff,
             a & 0xff);
    if (error == EHOSTUNREACH)
        note("nobody has the address %u.%u.%u.%u", a >> 24, a >> 16 & 0xff, a >> 8 & 0xff, a & 0xff);
    if (error == EADDRINUSE) note("the port %u is in use on this board", address.port);
    if (error == EADDRNOTAVAIL)
        note("the address %u.%u.%u.%u is not this board's", a >> 24, a >> 16 & 0xff, a >> 8 & 0xff, a & 0xff);
    errno = error;
    return result;
}

bool put_address(const OpenFile& file, const wire::SocketAddress& address, sockaddr* theirs,
                 socklen_t* length) {
    if (theirs == nullptr || length == nullptr) return true;
    socklen_t room = 0;
    if (!get_from_program(room, length)) return false;
    if (static_cast<int>(room) < 0) {
        errno = EINVAL;
        return false;
    }
    union {
        sockaddr_in place;
        sockaddr_nl number;
    } given{};
    std::size_t size = sizeof given.place;
    if (file.netlink) {
        given.number.nl_family = AF_NETLINK;
        given.number.nl_pid = address.address;
        size = sizeof given.number;
    } else {
        given.place.sin_family = AF_INET;
        given.place.sin_addr.s_addr = htonl(address.address);
        given.place.sin_port = htons(address.port);
    }
    if (!copy_to_program(theirs, &given, std::min<std::size_t>(room, size))) return false;
    return put_to_program(length, static_cast<socklen_t>(size));
}

}  // namespace puckloop::shim

namespace {

/// The program's address of a netlink socket.
bool get_number(wire::SocketAddress& address, const sockaddr* theirs, socklen_t length) {
    sockaddr_nl given{};
    if (length < sizeof given) return fail(EINVAL) == 0;
    if (!copy_from_program(&given, theirs, sizeof given)) return false;
    if (given.nl_family != AF_NETLINK) return fail(EINVAL) == 0;
    address = {given.nl_pid, 0, 0};
    return true;
}

/// The program's address; false and errno for what is none.
bool get_address(const OpenFile& file, wire::SocketAddress& address, const sockaddr* theirs,
                 socklen_t length) {
    if (file.netlink) return get_number(address, theirs, length);
    sockaddr_in given{};
    if (length < sizeof(sa_family_t)) return fail(EINVAL) == 0;
    if (!copy_from_program(&given, theirs, std::min<std::size_t>(length, sizeof given))) return false;
    if (given.sin_family != AF_INET) return fail(EAFNOSUPPORT) == 0;
    if (length < sizeof given) return fail(EINVAL) == 0;
    address = {ntohl(given.sin_addr.s_addr), ntohs(given.sin_port), 0};
    return true;
}

/// A descriptor for what the node has opened as `handle`.
OpenFile* new_file(int handle, bool stream, int type_flags, int& fd) {
    const int kind = (stream ? SOCK_STREAM : SOCK_DGRAM) | (type_flags & SOCK_CLOEXEC);
    fd = REAL(socket)(AF_UNIX, kind, 0);
    OpenFile* file = fd >= 0 ? adopt_descriptor(fd) : nullptr;
    if (file == nullptr) {
        const int error = errno;
        wire::Request request;
        request.op = wire::Op::Close;
        request.handle = handle;
        device_call(request);
        errno = error;
        return nullptr;
    }
    file->kind = OpenFile::Kind::Socket;
    file->path = kSocketPath;
    file->handle = handle;
    file->stream = stream;
    file->flags = O_RDWR | ((type_flags & SOCK_NONBLOCK) != 0 ? O_NONBLOCK : 0);
    return file;
}

int new_descriptor(int handle, bool stream, int type_flags) {
    int fd = -1;
    return new_file(handle, stream, type_flags, fd) != nullptr ? fd : -1;
}

/// What a kernel without this family, or a user without rights, answers.
int refuse_family(int domain, int type) {
    if (domain == AF_PACKET || type == SOCK_RAW) {
        note("raw and packet sockets are not allowed on the network");
        return fail(EPERM);
    }
    note("sockets of the address family %d are not carried by the network", domain);
    return fail(EAFNOSUPPORT);
}

/// NETLINK_ROUTE; other protocols are modules that a kernel need not have.
int open_netlink(int type, int protocol) {
    mark_call("socket");
    charge(page().charges.device);
    const int kind = type & ~(SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (kind != SOCK_RAW && kind != SOCK_DGRAM) return fail(ESOCKTNOSUPPORT);
    if (protocol != NETLINK_ROUTE) {
        note("netlink sockets of the protocol %d are not carried by the network", protocol);
        return fail(EPROTONOSUPPORT);
    }
    wire::Request request;
    request.op = wire::Op::Socket;
    request.a = wire::kNetlinkSocket;
    const auto handle = static_cast<int>(device_call(request));
    int fd = -1;
    OpenFile* const file = handle < 0 ? nullptr : new_file(handle, false, type, fd);
    if (file == nullptr) return -1;
    file->netlink = true;
    return fd;
}

int open_socket(int domain, int type, int protocol) {
    mark_call("socket");
    charge(page().charges.device);
    constexpr int kFlags = SOCK_NONBLOCK | SOCK_CLOEXEC, kLastType = SOCK_PACKET;
    const int kind = type & ~kFlags;
    if (domain != AF_INET || kind == SOCK_RAW) return refuse_family(domain, kind);
    const bool stream = kind == SOCK_STREAM;
    if (kind < 0 || kind > kLastType) return fail(EINVAL);
    if (!stream && kind != SOCK_DGRAM) return fail(ESOCKTNOSUPPORT);
    const bool echo = !stream && protocol == IPPROTO_ICMP;
    if (protocol != 0 && !echo && protocol != (stream ? IPPROTO_TCP : IPPROTO_UDP)) {
        note("sockets of the IP protocol %d are not carried by the network", protocol);
        return fail(EPROTONOSUPPORT);
    }
    wire::Request request;
    request.op = wire::Op::Socket;
    request.a = stream ? 1 : echo ? 2 : 0;
    const auto handle = static_cast<int>(device_call(request));
    return handle < 0 ? -1 : new_descriptor(handle, stream, type);
}

}  // namespace

SHIM_EXPORT int socket(int domain, int type, int protocol) noexcept {
    if (!networked() || domain == AF_UNIX) return REAL(socket)(domain, type, protocol);
    return domain == AF_NETLINK ? open_netlink(type, protocol) : open_socket(domain, type, protocol);
}

SHIM_EXPORT int bind(int fd, const sockaddr* address, socklen_t length) noexcept {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(bind)(fd, address, length);
    mark_call("bind");
    charge(page().charges.device);
    wire::SocketAddress to;
    if (!get_address(*file, to, address, length)) return -1;
    return static_cast<int>(named(device_call(device_request(*file, wire::Op::Bind), &to, sizeof to), to));
}

SHIM_EXPORT int listen(int fd, int backlog) noexcept {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(listen)(fd, backlog);
    mark_call("listen");
    charge(page().charges.device);
    wire::Request request = device_request(*file, wire::Op::Listen);
    request.a = static_cast<std::uint32_t>(std::max(backlog, 0));
    return static_cast<int>(device_call(request));
}

SHIM_EXPORT int connect(int fd, const sockaddr* address, socklen_t length) {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(connect)(fd, address, length);
    mark_call("connect");
    pthread_testcancel();
    charge(page().charges.device);
    sa_family_t family = AF_INET;
    if (length >= sizeof family && !copy_from_program(&family, address, sizeof family)) return -1;
    wire::Request request = device_request(*file, wire::Op::Connect);
    wire::SocketAddress to;
    if (family == AF_UNSPEC && !file->stream) {
        request.a = 1;
    } else if (!get_address(*file, to, address, length)) {
        return -1;
    }
    return static_cast<int>(named(device_call(request, &to, sizeof to, nullptr, 0, true), to));
}

SHIM_EXPORT int accept4(int fd, sockaddr* from, socklen_t* length, int flags) {
    OpenFile* file = socket_file(fd);
    if (file == nullptr)
        return static_cast<int>(outside(fd, POLLIN, [&] { return REAL(accept4)(fd, from, length, flags); }));
    mark_call("accept");
    pthread_testcancel();
    charge(page().charges.device);
    if ((flags & ~(SOCK_NONBLOCK | SOCK_CLOEXEC)) != 0) return fail(EINVAL);
    if (!file->stream) return fail(EOPNOTSUPP);
    wire::SocketAddress peer;
    const auto handle = static_cast<int>(
        device_call(device_request(*file, wire::Op::Accept), nullptr, 0, &peer, sizeof peer, true));
    if (handle < 0) return -1;
    const int made = new_descriptor(handle, true, flags);
    if (made >= 0 && !put_address(*file, peer, from, length)) {
        const int error = errno;
        close(made);
        return fail(error);
    }
    return made;
}

SHIM_EXPORT int accept(int fd, sockaddr* from, socklen_t* length) {
    return accept4(fd, from, length, 0);
}

SHIM_EXPORT int shutdown(int fd, int how) noexcept {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(shutdown)(fd, how);
    mark_call("shutdown");
    charge(page().charges.device);
    wire::Request request = device_request(*file, wire::Op::Shutdown);
    request.a = static_cast<std::uint32_t>(how);
    return static_cast<int>(device_call(request));
}

namespace {
int name_of_end(OpenFile& file, bool peer, sockaddr* name, socklen_t* length) {
    charge(page().charges.device);
    wire::Request request = device_request(file, wire::Op::SocketName);
    request.a = peer ? 1 : 0;
    wire::SocketAddress address;
    if (device_call(request, nullptr, 0, &address, sizeof address) < 0) return -1;
    if (name == nullptr || length == nullptr) return fail(EFAULT);
    return put_address(file, address, name, length) ? 0 : -1;
}
}  // namespace

SHIM_EXPORT int getsockname(int fd, sockaddr* name, socklen_t* length) noexcept {
    OpenFile* file = socket_file(fd);
    return file != nullptr ? name_of_end(*file, false, name, length) : REAL(getsockname)(fd, name, length);
}

SHIM_EXPORT int getpeername(int fd, sockaddr* name, socklen_t* length) noexcept {
    OpenFile* file = socket_file(fd);
    return file != nullptr ? name_of_end(*file, true, name, length) : REAL(getpeername)(fd, name, length);
}

SHIM_EXPORT int setsockopt(int fd, int level, int name, const void* value, socklen_t length) noexcept {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(setsockopt)(fd, level, name, value, length);
    mark_call("setsockopt");
    charge(page().charges.device);
    char bytes[64] = {};
    const std::size_t size = std::min<std::size_t>(length, sizeof bytes);
    if (static_cast<int>(length) < 0) return fail(EINVAL);
    if (!copy_from_program(bytes, value, size)) return -1;
    wire::Request request = device_request(*file, wire::Op::SetOption);
    request.a = static_cast<std::uint32_t>(level);
    request.b = static_cast<std::uint32_t>(name);
    const auto result = static_cast<int>(device_call(request, bytes, size));
    if (result < 0 && errno == ENOPROTOOPT)
        note("the socket option %d of level %d is not carried by the network", name, level);
    return result;
}

SHIM_EXPORT int getsockopt(int fd, int level, int name, void* value, socklen_t* length) noexcept {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) {
        const int result = REAL(getsockopt)(fd, level, name, value, length);
        if (active() && result == 0 && level == SOL_SOCKET && name == SO_PEERCRED && *length >= sizeof(pid_t))
            *static_cast<pid_t*>(value) = program_process(*static_cast<const pid_t*>(value));
        return result;
    }
    mark_call("getsockopt");
    charge(page().charges.device);
    socklen_t room = 0;
    if (!get_from_program(room, length)) return -1;
    if (static_cast<int>(room) < 0) return fail(EINVAL);
    wire::Request request = device_request(*file, wire::Op::GetOption);
    request.a = static_cast<std::uint32_t>(level);
    request.b = static_cast<std::uint32_t>(name);
    char bytes[256] = {};
    std::size_t size = 0;
    if (device_call(request, nullptr, 0, bytes, sizeof bytes, false, &size) < 0) return -1;
    size = std::min<std::size_t>(size, room);
    if (!copy_to_program(value, bytes, size)) return -1;
    return put_to_program(length, static_cast<socklen_t>(size)) ? 0 : -1;
}
