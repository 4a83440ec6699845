// System calls on descriptors: devices, pipes, waiting.

#include "linuxboard/shim/preload/host/kernel_signals.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/syscalls/syscalls.h"

#include <dirent.h>
#include <fcntl.h>
#include <mqueue.h>
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/select.h>
#include <sys/sem.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>

namespace puckloop::shim {

namespace {
/// The kernel's set of signals as the C library's; nullptr stays.
class Mask {
  public:
    explicit Mask(const void* kernels) {
        std::uint64_t mask = 0;
        given_ = kernels != nullptr && get_from_program(mask, kernels);
        set_ = set_of_kernel(mask);
    }
    operator const sigset_t*() const { return given_ ? &set_ : nullptr; }

  private:
    sigset_t set_;
    bool given_ = false;
};

Mask mask_of(const Argument& kernels) {
    return Mask(kernels);
}

long pselect6(const Argument (&a)[6]) {
    const void* mask[2] = {nullptr, nullptr};  // and its size
    if (a[5].value != 0 && !copy_from_program(mask, a[5], sizeof mask)) return -1;
    return pselect(a[0], a[1], a[2], a[3], a[4], Mask(mask[0]));
}

#if defined(__x86_64__)
/// The older call's entries are as long as those of getdents64(), with the type in the last byte.
long getdents(int fd, char* entries, std::size_t room) {
    constexpr std::size_t kType = offsetof(dirent64, d_type), kName = offsetof(dirent64, d_name);
    const ssize_t size = getdents64(fd, entries, room);
    for (char* entry = entries; entry < entries + size;) {
        const std::size_t length = reinterpret_cast<const dirent64*>(entry)->d_reclen;
        const char type = entry[kType];
        std::memmove(entry + kType, entry + kName, length - kName);
        entry[length - 1] = type;
        entry += length;
    }
    return size;
}
#endif
}  // namespace

bool file_syscall(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
        PUCKLOOP_SYSCALL(dup2, dup2(a[0], a[1]));
        PUCKLOOP_SYSCALL(getdents, getdents(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(pipe, pipe(a[0]));
        PUCKLOOP_SYSCALL(poll, poll(static_cast<pollfd*>(a[0]), a[1], a[2]));
        PUCKLOOP_SYSCALL(select, select(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(epoll_create, epoll_create(a[0]));
        PUCKLOOP_SYSCALL(epoll_wait, epoll_wait(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(eventfd, eventfd(a[0], 0));
#endif
        PUCKLOOP_SYSCALL(close, close(a[0]));
        PUCKLOOP_SYSCALL(close_range, close_range(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(getdents64, getdents64(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(dup, dup(a[0]));
        PUCKLOOP_SYSCALL(dup3, dup3(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(pipe2, pipe2(a[0], a[1]));
        PUCKLOOP_SYSCALL(socketpair, socketpair(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(fcntl, fcntl(a[0], a[1], a[2].value));
        PUCKLOOP_SYSCALL(flock, flock(a[0], a[1]));
        PUCKLOOP_SYSCALL(ioctl, ioctl(a[0], static_cast<unsigned long>(a[1]), a[2].value));
        PUCKLOOP_SYSCALL(read, read(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(write, write(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(readv, readv(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(writev, writev(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(pread64, pread(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(pwrite64, pwrite(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(preadv, preadv(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(pwritev, pwritev(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(preadv2, preadv2(a[0], a[1], a[2], a[3], a[5]));
        PUCKLOOP_SYSCALL(pwritev2, pwritev2(a[0], a[1], a[2], a[3], a[5]));
        PUCKLOOP_SYSCALL(lseek, lseek(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(sendfile, sendfile(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(splice, splice(a[0], a[1], a[2], a[3], a[4], a[5]));
        PUCKLOOP_SYSCALL(tee, tee(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(vmsplice, vmsplice(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(semop, semop(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(semtimedop, semtimedop(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(msgrcv, msgrcv(a[0], a[1], a[2], a[3].value, a[4]));
        PUCKLOOP_SYSCALL(msgsnd, msgsnd(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(mq_timedreceive, mq_timedreceive(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(mq_timedsend, mq_timedsend(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(copy_file_range, copy_file_range(a[0], a[1], a[2], a[3], a[4], a[5]));
        PUCKLOOP_SYSCALL(fstat, fstat(a[0], a[1]));
        PUCKLOOP_SYSCALL(fchmod, fchmod(a[0], a[1]));
        PUCKLOOP_SYSCALL(fchown, fchown(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(mmap, reinterpret_cast<long>(mmap(a[0], a[1], a[2], a[3], a[4], a[5])));
        PUCKLOOP_SYSCALL(ppoll, ppoll(a[0], a[1], a[2], mask_of(a[3])));
        PUCKLOOP_SYSCALL(pselect6, pselect6(a));
        PUCKLOOP_SYSCALL(epoll_create1, epoll_create1(a[0]));
        PUCKLOOP_SYSCALL(epoll_ctl, epoll_ctl(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(epoll_pwait, epoll_pwait(a[0], a[1], a[2], a[3], mask_of(a[4])));
        PUCKLOOP_SYSCALL(epoll_pwait2, epoll_pwait2(a[0], a[1], a[2], a[3], mask_of(a[4])));
        PUCKLOOP_SYSCALL(eventfd2, eventfd(a[0], a[1]));
        PUCKLOOP_SYSCALL(timerfd_create, timerfd_create(a[0], a[1]));
        PUCKLOOP_SYSCALL(timerfd_settime, timerfd_settime(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(timerfd_gettime, timerfd_gettime(a[0], a[1]));
        PUCKLOOP_SYSCALL(socket, socket(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(bind, bind(a[0], static_cast<sockaddr*>(a[1]), a[2]));
        PUCKLOOP_SYSCALL(listen, listen(a[0], a[1]));
        PUCKLOOP_SYSCALL(connect, connect(a[0], static_cast<sockaddr*>(a[1]), a[2]));
        PUCKLOOP_SYSCALL(shutdown, shutdown(a[0], a[1]));
        PUCKLOOP_SYSCALL(getsockname, getsockname(a[0], static_cast<sockaddr*>(a[1]), a[2]));
        PUCKLOOP_SYSCALL(getpeername, getpeername(a[0], static_cast<sockaddr*>(a[1]), a[2]));
        PUCKLOOP_SYSCALL(setsockopt, setsockopt(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(getsockopt, getsockopt(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(sendto, sendto(a[0], a[1], a[2], a[3], static_cast<sockaddr*>(a[4]), a[5]));
        PUCKLOOP_SYSCALL(sendmsg, sendmsg(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(sendmmsg, sendmmsg(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(recvmmsg, recvmmsg(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(accept4, accept4(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(accept, accept(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(recvfrom, recvfrom(a[0], a[1], a[2], a[3], a[4], a[5]));
        PUCKLOOP_SYSCALL(recvmsg, recvmsg(a[0], a[1], a[2]));
    default:
        return false;
    }
}

}  // namespace puckloop::shim
