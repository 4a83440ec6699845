// System calls with a path, which may lead to a device.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/syscalls/syscalls.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>
#include <utime.h>

namespace puckloop::shim {

bool path_syscall(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
        PUCKLOOP_SYSCALL(open, open(static_cast<const char*>(a[0]), a[1], static_cast<mode_t>(a[2])));
        PUCKLOOP_SYSCALL(creat, creat(a[0], a[1]));
        PUCKLOOP_SYSCALL(stat, stat(static_cast<const char*>(a[0]), a[1]));
        PUCKLOOP_SYSCALL(lstat, lstat(static_cast<const char*>(a[0]), a[1]));
        PUCKLOOP_SYSCALL(access, access(a[0], a[1]));
        PUCKLOOP_SYSCALL(readlink, readlink(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(unlink, unlink(a[0]));
        PUCKLOOP_SYSCALL(rename, rename(a[0], a[1]));
        PUCKLOOP_SYSCALL(chmod, chmod(a[0], a[1]));
        PUCKLOOP_SYSCALL(chown, chown(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(lchown, lchown(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(utime, utime(a[0], a[1]));
        PUCKLOOP_SYSCALL(utimes, utimes(a[0], a[1]));
        PUCKLOOP_SYSCALL(renameat, renameat(a[0], a[1], a[2], a[3]));
#endif
        PUCKLOOP_SYSCALL(openat,
                         openat(a[0], static_cast<const char*>(a[1]), a[2], static_cast<mode_t>(a[3])));
        PUCKLOOP_SYSCALL(newfstatat, fstatat(a[0], static_cast<const char*>(a[1]), a[2], a[3]));
        PUCKLOOP_SYSCALL(statx, statx(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(faccessat, faccessat(a[0], a[1], a[2], 0));
        PUCKLOOP_SYSCALL(faccessat2, faccessat(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(readlinkat, readlinkat(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(chdir, chdir(a[0]));
        PUCKLOOP_SYSCALL(unlinkat, unlinkat(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(renameat2, renameat2(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(fchmodat, fchmodat(a[0], a[1], a[2], 0));
        PUCKLOOP_SYSCALL(fchownat, fchownat(a[0], a[1], a[2], a[3], a[4]));
        PUCKLOOP_SYSCALL(utimensat,
                         a[1].value == 0 ? futimens(a[0], a[2]) : utimensat(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(truncate, truncate(a[0], a[1]));
    case SYS_openat2: {
        if (device_at(a[0], a[1]) == kNoDevice) return false;
        std::uint64_t flags = 0;
        *result = get_from_program(flags, a[2])
                      ? openat(a[0], static_cast<const char*>(a[1]), static_cast<int>(flags), 0)
                      : -1;
        return true;
    }
    default:
        return false;
    }
}

}  // namespace puckloop::shim
