// What moves data through sockets: send, recv and their kin.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"
#include "linuxboard/shim/preload/waiting/outside.h"
#include "linuxboard/shim/wire/interfaces.h"

#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

using namespace puckloop::shim;

extern "C" {
ssize_t __recv_chk(int, void*, size_t, size_t, int);
ssize_t __recvfrom_chk(int, void*, size_t, size_t, int, sockaddr*, socklen_t*);
}

namespace {

int refuse_urgent(int error) {
    note("urgent data (MSG_OOB) is not carried by the network");
    return fail(error);
}

bool waits(const OpenFile& file, int flags) {
    return (file.flags & O_NONBLOCK) == 0 && (flags & MSG_DONTWAIT) == 0;
}

/// One datagram, or one piece of a stream.
std::int64_t send_piece(OpenFile& file, const char* data, std::size_t size, int flags,
                        const wire::SocketAddress* to) {
    wire::Request request;
    request.op = wire::Op::Send;
    request.handle = file.handle;
    request.nonblocking = !waits(file, flags);
    if (file.stream && (flags & MSG_MORE) != 0) request.b = wire::kSendMore;
    std::vector<char> all(data, data + size);
    if (to != nullptr) {
        request.a = 1;
        const char* head = reinterpret_cast<const char*>(to);
        all.insert(all.begin(), head, head + sizeof *to);
    }
    std::size_t done = 0;
    for (; all.size() - done > wire::kMaximumData; done += wire::kMaximumData) {
        wire::Request begin = request;
        begin.b = wire::kSendPart;
        device_call(begin, all.data() + done, wire::kMaximumData);
    }
    const std::int64_t sent = device_call(request, all.data() + done, all.size() - done, nullptr, 0, true);
    return to != nullptr ? named(sent, *to) : sent;
}

struct Arrived {
    std::vector<char> data;
    wire::SocketReceived head{};
};

std::int64_t receive(OpenFile& file, std::size_t most, int flags, Arrived& arrived) {
    mark_call("recv");
    pthread_testcancel();
    charge(page().charges.device);
    if ((flags & MSG_OOB) != 0) return refuse_urgent(EINVAL);  // as where none has come
    if ((flags & MSG_ERRQUEUE) != 0) return fail(EAGAIN);
    constexpr std::size_t kMostOfStream = wire::kMaximumData - sizeof(wire::SocketReceived);
    constexpr std::size_t kMostOfDatagram = 65'535;
    wire::Request request;
    request.op = wire::Op::Receive;
    request.handle = file.handle;
    request.a = static_cast<std::uint32_t>(std::min(most, file.stream ? kMostOfStream : kMostOfDatagram));
    request.b = ((flags & MSG_PEEK) != 0 ? wire::kReceivePeek : 0) |
                ((flags & MSG_WAITALL) != 0 ? wire::kReceiveAll : 0);
    request.nonblocking = !waits(file, flags);
    std::vector<char> answer(sizeof arrived.head + request.a);
    std::size_t size = 0;
    const std::int64_t result = device_call(request, nullptr, 0, answer.data(), answer.size(), true, &size);
    if (result < 0) return -1;
    const std::size_t whole = sizeof arrived.head + static_cast<std::size_t>(result);
    while (size < std::min(whole, answer.size())) {
        request.b = wire::kReceiveRest;
        std::size_t more = 0;
        if (device_call(request, nullptr, 0, answer.data() + size, answer.size() - size, false, &more) <= 0)
            break;
        size += more;
    }
    std::memcpy(&arrived.head, answer.data(), std::min(size, sizeof arrived.head));
    arrived.data.assign(answer.begin() + sizeof arrived.head,
                        answer.begin() + static_cast<std::ptrdiff_t>(std::max(size, sizeof arrived.head)));
    // A stream's next piece, where all of it is wanted.
    const bool goes_on = file.stream && (flags & MSG_WAITALL) != 0 && (flags & MSG_PEEK) == 0 &&
                         arrived.data.size() == kMostOfStream && most > kMostOfStream;
    if (!goes_on) return result;
    Arrived rest;
    if (receive(file, most - kMostOfStream, flags, rest) < 0) return result;
    arrived.data.insert(arrived.data.end(), rest.data.begin(), rest.data.end());
    return static_cast<std::int64_t>(arrived.data.size());
}

/// What a call on a datagram of `size` octets answers that has room for less.
std::int64_t length_of(const OpenFile& file, const Arrived& arrived, int flags) {
    const bool whole = !file.stream && (flags & MSG_TRUNC) != 0;
    return whole ? arrived.head.size : static_cast<std::int64_t>(arrived.data.size());
}

/// The program's parts of a message.
bool get_vector(std::vector<iovec>& parts, const msghdr& message) {
    if (message.msg_iovlen > IOV_MAX) return fail(EMSGSIZE) == 0;
    parts.resize(message.msg_iovlen);
    return copy_from_program(parts.data(), message.msg_iov, parts.size() * sizeof(iovec));
}

/// With one interface the address and interface that a datagram is to go out by (IP_PKTINFO) are known.
bool check_control(const msghdr& message) {
    std::vector<char> control(std::min<std::size_t>(message.msg_controllen, 4096));
    if (!copy_from_program(control.data(), message.msg_control, control.size())) return false;
    msghdr copy{};
    copy.msg_control = control.data();
    copy.msg_controllen = control.size();
    for (const cmsghdr* part = CMSG_FIRSTHDR(&copy); part != nullptr;
         part = CMSG_NXTHDR(&copy, const_cast<cmsghdr*>(part)))
        if (part->cmsg_level != IPPROTO_IP || part->cmsg_type != IP_PKTINFO)
            note("control data of sendmsg() of level %d and type %d is not carried by the network",
                 part->cmsg_level, part->cmsg_type);
    return true;
}

/// What the socket's options want beside a datagram, in Linux' order, as far as there is room.
bool put_control(const wire::SocketReceived& head, msghdr& message) {
    alignas(cmsghdr) char control[256] = {};
    std::size_t size = 0;
    const auto add = [&](int level, int type, const auto& value) {
        auto* part = reinterpret_cast<cmsghdr*>(control + size);
        part->cmsg_level = level;
        part->cmsg_type = type;
        part->cmsg_len = CMSG_LEN(sizeof value);
        std::memcpy(CMSG_DATA(part), &value, sizeof value);
        size += CMSG_SPACE(sizeof value);
    };
    const std::int64_t since = std::max<std::int64_t>(now() - head.time, 0) / kNanosecond;
    const timespec stamp = timespec_of_nanoseconds(clock_nanoseconds(CLOCK_REALTIME) - since);
    if ((head.with & wire::kWithTime) != 0)
        add(SOL_SOCKET, SO_TIMESTAMP, timeval{stamp.tv_sec, stamp.tv_nsec / 1000});
    if ((head.with & wire::kWithFineTime) != 0) add(SOL_SOCKET, SO_TIMESTAMPNS, stamp);
    if ((head.with & wire::kWithPacketInfo) != 0) {
        const bool loopback = head.to >> 24 == 127 || head.from.address == page().network_address;
        in_pktinfo info{};
        info.ipi_ifindex = loopback ? wire::kLoopbackIndex : wire::kWirelessIndex;
        info.ipi_addr.s_addr = htonl(head.to);
        const bool own = head.to == page().network_address || head.to >> 24 == 127;
        info.ipi_spec_dst.s_addr = htonl(own ? head.to : page().network_address);
        add(IPPROTO_IP, IP_PKTINFO, info);
    }
    if ((head.with & wire::kWithTimeToLive) != 0) add(IPPROTO_IP, IP_TTL, int{head.time_to_live});
    if ((head.with & wire::kWithService) != 0) add(IPPROTO_IP, IP_TOS, head.service);
    const std::size_t room = message.msg_control != nullptr ? message.msg_controllen : 0;
    if (size > room) {
        message.msg_flags |= MSG_CTRUNC;
        size = 0;
    }
    message.msg_controllen = size;
    return size == 0 || copy_to_program(message.msg_control, control, size);
}

std::int64_t send_message(OpenFile& file, const msghdr& message, int flags) {
    std::vector<iovec> parts;
    if (!get_vector(parts, message)) return -1;
    constexpr std::size_t kMost = std::size_t{1} << 20;  // the rest is another call's
    std::vector<char> data;
    for (const iovec& part : parts) {
        const std::size_t before = data.size(), size = std::min(part.iov_len, kMost - before);
        data.resize(before + size);
        if (size > 0 && !copy_from_program(data.data() + before, part.iov_base, size)) return -1;
    }
    if (message.msg_controllen != 0 && !check_control(message)) return -1;
    if (message.msg_name == nullptr || file.stream || file.netlink)  // that has but one receiver: the kernel
        return send_bytes(file, data.data(), data.size(), flags, nullptr);
    sockaddr_in to{};
    if (message.msg_namelen < sizeof to) return fail(EINVAL);
    if (!copy_from_program(&to, message.msg_name, sizeof to)) return -1;
    if (to.sin_family != AF_INET) return fail(EAFNOSUPPORT);
    const wire::SocketAddress address{ntohl(to.sin_addr.s_addr), ntohs(to.sin_port), 0};
    return send_bytes(file, data.data(), data.size(), flags, &address);
}

std::int64_t receive_message(OpenFile& file, msghdr& message, int flags) {
    std::vector<iovec> parts;
    if (!get_vector(parts, message)) return -1;
    std::size_t room = 0;
    for (const iovec& part : parts)
        room += part.iov_len;
    Arrived arrived;
    if (receive(file, room, flags, arrived) < 0) return -1;
    std::size_t done = 0;
    for (const iovec& part : parts) {
        const std::size_t size = std::min(part.iov_len, arrived.data.size() - done);
        if (size > 0 && !copy_to_program(part.iov_base, arrived.data.data() + done, size)) return -1;
        done += size;
    }
    message.msg_flags = !file.stream && arrived.head.size > arrived.data.size() ? MSG_TRUNC : 0;
    if (file.stream)
        message.msg_controllen = 0;
    else if (!put_control(arrived.head, message))
        return -1;
    if (file.stream || message.msg_name == nullptr) {
        message.msg_namelen = 0;
    } else if (!put_address(file, arrived.head.from, static_cast<sockaddr*>(message.msg_name),
                            &message.msg_namelen)) {
        return -1;
    }
    return length_of(file, arrived, flags);
}

}  // namespace

namespace puckloop::shim {

std::int64_t send_bytes(OpenFile& file, const char* data, std::size_t size, int flags,
                        const wire::SocketAddress* to) {
    mark_call("send");
    pthread_testcancel();
    charge(page().charges.device);
    if ((flags & MSG_OOB) != 0) return refuse_urgent(EOPNOTSUPP);
    std::int64_t sent = 0;
    if (!file.stream) {
        constexpr std::size_t kMostOfDatagram = 65'507;
        if (size > kMostOfDatagram) return fail(EMSGSIZE);
        sent = send_piece(file, data, size, flags, to);
    }
    while (file.stream) {
        const std::size_t part = std::min<std::size_t>(size, wire::kMaximumData);
        const std::int64_t taken = send_piece(file, data, part, flags, nullptr);
        if (taken < 0) {
            if (sent == 0) sent = -1;
            break;
        }
        sent += taken;
        data += taken;
        size -= static_cast<std::size_t>(taken);
        if (size == 0 || static_cast<std::size_t>(taken) < part) break;
    }
    if (sent < 0 && errno == EPIPE && file.stream && (flags & MSG_NOSIGNAL) == 0) {
        raise(SIGPIPE);
        errno = EPIPE;
    }
    return sent;
}

std::int64_t write_socket(OpenFile& file, const void* data, std::size_t size, int flags) {
    // A copy: what is sent in pieces must be there as a whole.
    std::vector<char> bytes(std::min(size, std::size_t{1} << 20));
    if (!copy_from_program(bytes.data(), data, bytes.size())) return -1;
    return send_bytes(file, bytes.data(), bytes.size(), flags, nullptr);
}

std::int64_t read_socket(OpenFile& file, void* buffer, std::size_t size, int flags) {
    Arrived arrived;
    if (receive(file, size, flags, arrived) < 0) return -1;
    if (!copy_to_program(buffer, arrived.data.data(), arrived.data.size())) return -1;
    return length_of(file, arrived, flags);
}

}  // namespace puckloop::shim

SHIM_EXPORT ssize_t send(int fd, const void* data, size_t size, int flags) {
    if (OpenFile* file = socket_file(fd)) return write_socket(*file, data, size, flags);
    if ((flags & MSG_DONTWAIT) != 0) return REAL(send)(fd, data, size, flags);
    return outside(fd, POLLOUT, [&] { return REAL(send)(fd, data, size, flags); });
}

SHIM_EXPORT ssize_t sendto(int fd, const void* data, size_t size, int flags, const sockaddr* to,
                           socklen_t length) {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(sendto)(fd, data, size, flags, to, length);
    iovec part{const_cast<void*>(data), size};
    msghdr message{};
    message.msg_name = const_cast<sockaddr*>(to);
    message.msg_namelen = length;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    return send_message(*file, message, flags);
}

namespace {
/// Calls `change` for the process number of each part of the control data that has one; sockets of the host.
template <typename Change>
void change_credentials(msghdr& message, Change change) {
    for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
        const bool has_number = part->cmsg_level == SOL_SOCKET && part->cmsg_type == SCM_CREDENTIALS &&
                                part->cmsg_len >= CMSG_LEN(sizeof(ucred));
        if (has_number) change(reinterpret_cast<ucred*>(CMSG_DATA(part))->pid);
    }
}

/// A copy of the control data with the host's numbers. What is bad is the host's to find.
ssize_t send_outside(int fd, const msghdr* theirs, int flags) {
    constexpr std::size_t kMostControl = 1024;  // longer than any with a number: some descriptors
    msghdr message{};
    if (!get_from_program(message, theirs)) return -1;
    alignas(cmsghdr) char control[kMostControl];
    if (message.msg_control != nullptr && message.msg_controllen <= sizeof control &&
        copy_from_program(control, message.msg_control, message.msg_controllen)) {
        message.msg_control = control;
        change_credentials(message, [](pid_t& number) {
            if (const pid_t host = host_process(number); host > 0) number = host;
        });
    }
    if (networked()) give_descriptors(message);
    const ssize_t sent = REAL(sendmsg)(fd, &message, flags);
    if (sent < 0 && networked()) forget_given(message);
    return sent;
}
}  // namespace

SHIM_EXPORT ssize_t sendmsg(int fd, const msghdr* theirs, int flags) {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return active() ? send_outside(fd, theirs, flags) : REAL(sendmsg)(fd, theirs, flags);
    msghdr message{};
    return get_from_program(message, theirs) ? send_message(*file, message, flags) : -1;
}

SHIM_EXPORT int sendmmsg(int fd, mmsghdr* theirs, unsigned count, int flags) {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(sendmmsg)(fd, theirs, count, flags);
    for (unsigned i = 0; i < count; ++i) {
        mmsghdr one{};
        const bool there = get_from_program(one, theirs + i);
        const std::int64_t sent = there ? send_message(*file, one.msg_hdr, flags) : -1;
        if (sent < 0) return i > 0 ? static_cast<int>(i) : -1;
        one.msg_len = static_cast<unsigned>(sent);
        if (!put_to_program(theirs + i, one)) return -1;
    }
    return static_cast<int>(count);
}

SHIM_EXPORT ssize_t recv(int fd, void* buffer, size_t size, int flags) {
    if (OpenFile* file = socket_file(fd)) return read_socket(*file, buffer, size, flags);
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recv)(fd, buffer, size, flags);
    return outside(fd, POLLIN, [&] { return REAL(recv)(fd, buffer, size, flags); });
}

SHIM_EXPORT ssize_t __recv_chk(int fd, void* buffer, size_t size, size_t room, int flags) {
    if (size > room) __builtin_trap();
    return recv(fd, buffer, size, flags);
}

SHIM_EXPORT ssize_t recvfrom(int fd, void* buffer, size_t size, int flags, sockaddr* from,
                             socklen_t* length) {
    if (OpenFile* file = socket_file(fd)) {
        Arrived arrived;
        if (receive(*file, size, flags, arrived) < 0) return -1;
        if (!copy_to_program(buffer, arrived.data.data(), arrived.data.size())) return -1;
        if (file->stream) {
            if (from != nullptr && length != nullptr && !put_to_program(length, socklen_t{0})) return -1;
        } else if (!put_address(*file, arrived.head.from, from, length)) {
            return -1;
        }
        return length_of(*file, arrived, flags);
    }
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recvfrom)(fd, buffer, size, flags, from, length);
    return outside(fd, POLLIN, [&] { return REAL(recvfrom)(fd, buffer, size, flags, from, length); });
}

SHIM_EXPORT ssize_t __recvfrom_chk(int fd, void* buffer, size_t size, size_t room, int flags, sockaddr* from,
                                   socklen_t* length) {
    if (size > room) __builtin_trap();
    return recvfrom(fd, buffer, size, flags, from, length);
}

SHIM_EXPORT ssize_t recvmsg(int fd, msghdr* theirs, int flags) {
    if (OpenFile* file = socket_file(fd)) {
        msghdr message{};
        if (!get_from_program(message, theirs)) return -1;
        const std::int64_t received = receive_message(*file, message, flags);
        return received >= 0 && !put_to_program(theirs, message) ? -1 : received;
    }
    const ssize_t received = (flags & MSG_DONTWAIT) != 0
                                 ? REAL(recvmsg)(fd, theirs, flags)
                                 : outside(fd, POLLIN, [&] { return REAL(recvmsg)(fd, theirs, flags); });
    if (active() && received >= 0)
        change_credentials(*theirs, [](pid_t& number) { number = program_process(number); });
    if (networked() && received >= 0) {
        const int error = errno;
        take_descriptors(*theirs);
        errno = error;
    }
    return received;
}

SHIM_EXPORT int recvmmsg(int fd, mmsghdr* theirs, unsigned count, int flags, timespec* timeout) {
    OpenFile* file = socket_file(fd);
    if (file == nullptr) return REAL(recvmmsg)(fd, theirs, count, flags, timeout);
    for (unsigned i = 0; i < count; ++i) {
        mmsghdr one{};
        const int more = i > 0 && (flags & MSG_WAITFORONE) != 0 ? MSG_DONTWAIT : 0;
        const bool there = get_from_program(one, theirs + i);
        const std::int64_t received =
            there ? receive_message(*file, one.msg_hdr, (flags & ~MSG_WAITFORONE) | more) : -1;
        if (received < 0) return i > 0 ? static_cast<int>(i) : -1;
        one.msg_len = static_cast<unsigned>(received);
        if (!put_to_program(theirs + i, one)) return -1;
    }
    return static_cast<int>(count);
}

namespace puckloop::shim {

std::int64_t send_file(int to, int from, off_t* offset, std::size_t size) {
    OpenFile* file = socket_file(to);
    std::size_t done = 0;
    off_t place = 0;
    if (offset != nullptr && !get_from_program(place, offset)) return -1;
    while (done < size) {
        char part[wire::kMaximumData];
        const std::size_t wanted = std::min(size - done, sizeof part);
        const ssize_t count =
            offset != nullptr ? REAL(pread)(from, part, wanted, place) : REAL(read)(from, part, wanted);
        if (count <= 0) {
            if (count < 0 && done == 0) return -1;
            break;
        }
        const std::int64_t sent = send_bytes(*file, part, static_cast<std::size_t>(count), 0, nullptr);
        const std::int64_t taken = std::max<std::int64_t>(sent, 0);
        place += taken;
        done += static_cast<std::size_t>(taken);
        if (taken < count) {
            const int error = errno;
            if (offset == nullptr) REAL(lseek)(from, static_cast<off_t>(taken - count), SEEK_CUR);
            errno = error;
            if (sent < 0 && done == 0) return -1;
            break;
        }
    }
    if (offset != nullptr && !put_to_program(offset, place)) return -1;
    return static_cast<std::int64_t>(done);
}

}  // namespace puckloop::shim
