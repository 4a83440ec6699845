// syscall(): what has a function that is taken over goes to that function; what would escape simulated time
// is refused by name; the rest is the host's.

#include "linuxboard/shim/preload/calls.h"
#include "linuxboard/shim/preload/files/open_file.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/program_memory.h"
#include "linuxboard/shim/preload/real.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <linux/sched.h>
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/times.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdarg>

using namespace puckloop::shim;

namespace {
/// FUTEX_WAIT and FUTEX_WAKE among the program's threads; false if it is another operation.
bool futex(long* result, std::uint32_t* word, int operation, std::uint32_t value, const timespec* timeout,
           std::uint32_t bits) {
    const int command = operation & FUTEX_CMD_MASK;
    const bool waits = command == FUTEX_WAIT || command == FUTEX_WAIT_BITSET;
    if (command == FUTEX_WAKE || command == FUTEX_WAKE_BITSET) {
        const int count = static_cast<int>(std::min<std::uint32_t>(value, INT_MAX));
        *result = wake(word, count, command == FUTEX_WAKE_BITSET ? bits : ~std::uint64_t{0});
        charge(page().charges.sync);
        return true;
    }
    if (!waits) return false;
    mark_call("futex");
    charge(page().charges.sync);
    *result = -1;
    std::uint32_t current = 0;
    timespec time{};
    if (!get_from_program(current, word) || (timeout != nullptr && !get_from_program(time, timeout)))
        return true;
    if (__atomic_load_n(word, __ATOMIC_SEQ_CST) != value) {
        errno = EAGAIN;
        return true;
    }
    WaitOptions options;
    options.interruptible = true;
    if (command == FUTEX_WAIT_BITSET) options.bits = bits;
    if (timeout != nullptr) {
        const clockid_t clock = (operation & FUTEX_CLOCK_REALTIME) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
        options.deadline =
            command == FUTEX_WAIT ? time_after(from_timespec(time)) : absolute_deadline(clock, time);
    }
    switch (park_shared(word, options, (operation & FUTEX_PRIVATE_FLAG) == 0)) {
    case Wake::Timeout:
        errno = ETIMEDOUT;
        break;
    case Wake::Signal:
        errno = EINTR;
        break;
    default:
        *result = 0;
        break;
    }
    return true;
}

/// An argument as the call takes it.
struct Argument {
    long value = 0;
    template <typename T>
    operator T*() const {
        return reinterpret_cast<T*>(value);
    }
    template <typename T, typename = std::enable_if_t<std::is_integral_v<T> || std::is_enum_v<T>>>
    operator T() const {
        return static_cast<T>(value);
    }
};

long failed(int error) {
    if (error == 0) return 0;
    errno = error;
    return -1;
}

long clone3(const void* argument, std::size_t size) {
    clone_args wanted{};
    if (size < CLONE_ARGS_SIZE_VER0) return failed(EINVAL);
    if (!copy_from_program(&wanted, argument, std::min(size, sizeof wanted))) return -1;
    const auto pointer = [](std::uint64_t number) { return reinterpret_cast<void*>(number); };
    return clone_process("syscall(SYS_clone3)", wanted.flags, static_cast<int>(wanted.exit_signal),
                         pointer(wanted.stack), pointer(wanted.parent_tid), pointer(wanted.child_tid));
}

/// A signal for one thread of this process; false if it is none of this program's.
bool signal_thread(long* result, pid_t process, pid_t thread, int number) {
    if (process >= 0 && process != own().number) return false;
    for (std::size_t i = 0; i < thread_count(); ++i) {
        const Thread* candidate = thread_at(i);
        if (candidate == nullptr || !candidate->has_handle || thread_number(candidate->index) != thread)
            continue;
        *result = failed(pthread_kill(candidate->handle, number));
        return true;
    }
    return false;
}

/// Files, devices and waiting. False if the call is another one.
bool file_call(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
    case SYS_open:
        *result = open(static_cast<const char*>(a[0]), a[1], static_cast<mode_t>(a[2]));
        return true;
    case SYS_creat:
        *result = creat(static_cast<const char*>(a[0]), a[1]);
        return true;
    case SYS_dup2:
        *result = dup2(a[0], a[1]);
        return true;
    case SYS_pipe:
        *result = pipe(a[0]);
        return true;
    case SYS_poll:
        *result = poll(static_cast<pollfd*>(a[0]), a[1], a[2]);
        return true;
    case SYS_select:
        *result = select(a[0], a[1], a[2], a[3], a[4]);
        return true;
    case SYS_epoll_wait:
        *result = epoll_wait(a[0], a[1], a[2], a[3]);
        return true;
#endif
    case SYS_openat:
        *result = openat(a[0], static_cast<const char*>(a[1]), a[2], static_cast<mode_t>(a[3]));
        return true;
    case SYS_openat2: {
        if (device_at(a[0], a[1]) == kNoDevice) return false;
        std::uint64_t flags = 0;
        *result = get_from_program(flags, a[2])
                      ? openat(a[0], static_cast<const char*>(a[1]), static_cast<int>(flags), 0)
                      : -1;
        return true;
    }
    case SYS_close:
        *result = close(a[0]);
        return true;
    case SYS_close_range:
        *result = close_range(a[0], a[1], a[2]);
        return true;
    case SYS_dup:
        *result = dup(a[0]);
        return true;
    case SYS_dup3:
        *result = dup3(a[0], a[1], a[2]);
        return true;
    case SYS_pipe2:
        *result = pipe2(a[0], a[1]);
        return true;
    case SYS_fcntl:
        *result = fcntl(a[0], a[1], a[2].value);
        return true;
    case SYS_flock:
        *result = flock(a[0], a[1]);
        return true;
    case SYS_ioctl:
        *result = ioctl(a[0], static_cast<unsigned long>(a[1]), a[2].value);
        return true;
    case SYS_read:
        *result = read(a[0], a[1], a[2]);
        return true;
    case SYS_write:
        *result = write(a[0], a[1], a[2]);
        return true;
    case SYS_readv:
        *result = readv(a[0], a[1], a[2]);
        return true;
    case SYS_writev:
        *result = writev(a[0], a[1], a[2]);
        return true;
    case SYS_pread64:
        *result = pread(a[0], a[1], a[2], a[3]);
        return true;
    case SYS_pwrite64:
        *result = pwrite(a[0], a[1], a[2], a[3]);
        return true;
    case SYS_lseek:
        *result = lseek(a[0], a[1], a[2]);
        return true;
    case SYS_fstat:
        *result = fstat(a[0], a[1]);
        return true;
    case SYS_mmap:
        *result = reinterpret_cast<long>(mmap(a[0], a[1], a[2], a[3], a[4], a[5]));
        return true;
    case SYS_epoll_ctl:
        *result = epoll_ctl(a[0], a[1], a[2], a[3]);
        return true;
    default:
        return false;
    }
}

/// Time, and who the process is. False if the call is another one.
bool time_call(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
    case SYS_time:
        *result = time(a[0]);
        return true;
    case SYS_alarm:
        *result = alarm(a[0]);
        return true;
#endif
    case SYS_clock_gettime:
        *result = clock_gettime(a[0], a[1]);
        return true;
    case SYS_gettimeofday:
        *result = gettimeofday(a[0], nullptr);
        return true;
    case SYS_times:
        *result = times(a[0]);
        return true;
    case SYS_getrusage:
        *result = getrusage(static_cast<__rusage_who_t>(a[0].value), a[1]);
        return true;
    case SYS_nanosleep:
        *result = nanosleep(a[0], a[1]);
        return true;
    case SYS_clock_nanosleep:
        *result = failed(clock_nanosleep(a[0], a[1], a[2], a[3]));
        return true;
    case SYS_clock_settime:
        *result = clock_settime(a[0], a[1]);
        return true;
    case SYS_settimeofday:
        *result = settimeofday(a[0], nullptr);
        return true;
    case SYS_sched_yield:
        *result = sched_yield();
        return true;
    case SYS_getrandom:
        *result = getrandom(a[0], a[1], a[2]);
        return true;
    case SYS_getpid:
        *result = getpid();
        return true;
    case SYS_getppid:
        *result = getppid();
        return true;
    case SYS_gettid:
        *result = gettid();
        return true;
    case SYS_kill:
        *result = kill(a[0], a[1]);
        return true;
    case SYS_tgkill:
        return signal_thread(result, a[0], a[1], a[2]);
    case SYS_tkill:
        return signal_thread(result, -1, a[0], a[1]);
    default:
        return false;
    }
}

/// Processes that are made, replaced, ended. False if the call is another one.
bool process_call(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
    case SYS_fork:
    case SYS_vfork:
        *result = fork_plainly();
        return true;
    case SYS_clone:  // the order of the last arguments is this processor's
        *result = clone_process("syscall(SYS_clone)",
                                static_cast<std::uint64_t>(a[0].value) & ~std::uint64_t{CSIGNAL},
                                static_cast<int>(a[0].value & CSIGNAL), a[1], a[2], a[3]);
        return true;
#else
    case SYS_clone:
        *result = clone_process("syscall(SYS_clone)",
                                static_cast<std::uint64_t>(a[0].value) & ~std::uint64_t{CSIGNAL},
                                static_cast<int>(a[0].value & CSIGNAL), a[1], a[2], a[4]);
        return true;
#endif
    case SYS_clone3:
        *result = clone3(a[0], a[1]);
        return true;
    case SYS_execve:
        *result = execve(a[0], a[1], a[2]);
        return true;
    case SYS_execveat:
        refuse_call("syscall(SYS_execveat)", "which puts another program in its place past the library");
        return true;
    case SYS_wait4:
        *result = wait4(a[0], a[1], a[2], a[3]);
        return true;
    case SYS_exit_group:
        _exit(a[0]);
    case SYS_exit:
        if (thread_count() == 1) _exit(a[0]);
        return false;
    case SYS_ptrace:
        refuse_call("syscall(SYS_ptrace)", "with which debuggers stop processes outside of simulated time");
        return true;
    case SYS_io_uring_setup:
    case SYS_io_uring_enter:
    case SYS_io_uring_register:
        refuse_call("syscall(SYS_io_uring_setup)", "whose input and output pass by every call");
        return true;
    default:
        return false;
    }
}
}  // namespace

SHIM_EXPORT long syscall(long number, ...) noexcept {
    std::va_list list;
    va_start(list, number);
    Argument a[6];
    for (Argument& argument : a)
        argument.value = va_arg(list, long);
    va_end(list);
    long result = 0;
    if (active()) {
        if (number == SYS_futex) {
            if (futex(&result, a[0], a[1], a[2], a[3], a[5])) return result;
            note("futex operation 0x%lx is left to the host", a[1].value);
        } else if (file_call(number, a, &result) || time_call(number, a, &result) ||
                   process_call(number, a, &result)) {
            return result;
        }
    }
    return REAL(syscall)(number, a[0].value, a[1].value, a[2].value, a[3].value, a[4].value, a[5].value);
}
