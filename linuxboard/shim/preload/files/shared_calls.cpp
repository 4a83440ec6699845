// Calls that wait for another process without a descriptor to look at: locks of files, System V queues and
// semaphores; and message queues. While one process waited in the host no other could run, so each call is
// tried without waiting, once a millisecond of simulated time.

#include "linuxboard/shim/preload/files/shared_calls.h"
#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"
#include "linuxboard/shim/preload/waiting/outside.h"

#include <fcntl.h>
#include <mqueue.h>
#include <sys/file.h>
#include <sys/ipc.h>
#include <sys/msg.h>
#include <sys/sem.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

using namespace puckloop::shim;

namespace {
/// Tries until it is not `busy` any more; -1 with EINTR after a signal, with `too_late` once `deadline` is
/// over.
template <typename Try>
auto try_again(Try attempt, int busy, Time deadline = kNever, int too_late = EAGAIN) -> decltype(attempt()) {
    charge(page().charges.device);
    while (true) {
        const auto result = attempt();
        const int error = errno;
        if (result >= 0) {
            external_changed();
            tell_others();
            errno = error;
            return result;
        }
        if (error != busy || now() >= deadline) {
            errno = error != busy ? error : too_late;
            return result;
        }
        if (!look_again(deadline)) {
            errno = EINTR;
            return result;
        }
    }
}

bool conducted() {
    return active() && thread_count() > 0;
}

/// The end of an attempt: F_SETLK reports a lock of others as EACCES or EAGAIN.
int set_lock(int fd, int command, struct flock* lock) {
    const int result = REAL(fcntl)(fd, command, lock);
    if (result < 0 && errno == EACCES) errno = EAGAIN;
    return result;
}

bool never_waits(const sembuf* operations, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        if ((operations[i].sem_flg & IPC_NOWAIT) == 0) return false;
    return true;
}

int operate(int set, sembuf* theirs, std::size_t count, Time deadline) {
    constexpr std::size_t kMost = 500;  // SEMOPM
    if (count > kMost) return fail(E2BIG);
    std::vector<sembuf> operations(count);
    if (!copy_from_program(operations.data(), theirs, count * sizeof(sembuf))) return -1;
    if (never_waits(operations.data(), count)) return REAL(semop)(set, theirs, count);
    // One that may wait makes the whole call wait.
    std::vector<sembuf> now_or_never = operations;
    for (sembuf& operation : now_or_never)
        operation.sem_flg = static_cast<short>(operation.sem_flg | IPC_NOWAIT);
    return try_again([&] { return REAL(semop)(set, now_or_never.data(), count); }, EAGAIN, deadline);
}

/// A descriptor's own wish not to wait.
bool queue_never_waits(mqd_t queue) {
    mq_attr attributes{};
    return mq_getattr(queue, &attributes) != 0 || (attributes.mq_flags & O_NONBLOCK) != 0;
}

/// False with errno: not there, or not a time.
bool get_time(timespec& time, const timespec* theirs) {
    if (!get_from_program(time, theirs)) return false;
    if (is_valid(time)) return true;
    errno = EINVAL;
    return false;
}

/// `theirs` on CLOCK_REALTIME, as the calls of message queues have it; nullptr is never.
bool deadline_of(const timespec* theirs, Time& deadline) {
    timespec time{};
    deadline = kNever;
    if (theirs == nullptr) return true;
    if (!get_time(time, theirs)) return false;
    deadline = absolute_deadline(CLOCK_REALTIME, time);
    return true;
}

/// A time that has long been over: one try, without waiting.
constexpr timespec kAtOnce{0, 0};
}  // namespace

namespace puckloop::shim {
int wait_for_lock(int fd, int command, void* lock) {
    const int at_once = command == F_SETLKW ? F_SETLK : F_OFD_SETLK;
    return try_again([&] { return set_lock(fd, at_once, static_cast<struct flock*>(lock)); }, EAGAIN);
}
}  // namespace puckloop::shim

SHIM_EXPORT int flock(int fd, int operation) noexcept {
    if (open_file(fd) != nullptr) return 0;
    if (!conducted() || (operation & LOCK_NB) != 0 || is_link_descriptor(fd))
        return REAL(flock)(fd, operation);
    return try_again([&] { return REAL(flock)(fd, operation | LOCK_NB); }, EWOULDBLOCK);
}

namespace {
int lock_file(int fd, int command, off64_t length) {
    struct flock64 lock {};
    lock.l_type = command == F_ULOCK ? F_UNLCK : F_WRLCK;
    lock.l_whence = SEEK_CUR;
    lock.l_len = length;
    switch (command) {
    case F_ULOCK:
    case F_TLOCK:
        return fcntl(fd, F_SETLK, &lock);
    case F_LOCK:
        return fcntl(fd, F_SETLKW, &lock);
    case F_TEST:
        if (fcntl(fd, F_GETLK, &lock) != 0) return -1;
        if (lock.l_type == F_UNLCK) return 0;
        return fail(EACCES);
    default:
        return fail(EINVAL);
    }
}
}  // namespace

SHIM_EXPORT int lockf(int fd, int command, off_t length) {
    return active() ? lock_file(fd, command, length) : REAL(lockf)(fd, command, length);
}

SHIM_EXPORT int lockf64(int fd, int command, off64_t length) {
    return active() ? lock_file(fd, command, length) : REAL(lockf64)(fd, command, length);
}

SHIM_EXPORT int semop(int set, sembuf* operations, size_t count) noexcept {
    return conducted() ? operate(set, operations, count, kNever) : REAL(semop)(set, operations, count);
}

SHIM_EXPORT int semtimedop(int set, sembuf* operations, size_t count, const timespec* timeout) noexcept {
    if (!conducted()) return REAL(semtimedop)(set, operations, count, timeout);
    if (timeout == nullptr) return operate(set, operations, count, kNever);
    timespec time{};
    if (!get_time(time, timeout)) return -1;
    return operate(set, operations, count, time_after(from_timespec(time)));
}

SHIM_EXPORT ssize_t msgrcv(int queue, void* message, size_t size, long kind, int flags) {
    if (!conducted() || (flags & IPC_NOWAIT) != 0) return REAL(msgrcv)(queue, message, size, kind, flags);
    return try_again([&] { return REAL(msgrcv)(queue, message, size, kind, flags | IPC_NOWAIT); }, ENOMSG);
}

SHIM_EXPORT int msgsnd(int queue, const void* message, size_t size, int flags) {
    if (!conducted() || (flags & IPC_NOWAIT) != 0) return REAL(msgsnd)(queue, message, size, flags);
    return try_again([&] { return REAL(msgsnd)(queue, message, size, flags | IPC_NOWAIT); }, EAGAIN);
}

namespace {
/// `until` nullptr: however long it takes.
ssize_t receive_message(mqd_t queue, char* message, size_t size, unsigned* priority, const timespec* until) {
    Time deadline = kNever;
    if (!deadline_of(until, deadline)) return -1;
    return try_again([&] { return REAL(mq_timedreceive)(queue, message, size, priority, &kAtOnce); },
                     ETIMEDOUT, deadline, ETIMEDOUT);
}

int send_message(mqd_t queue, const char* message, size_t size, unsigned priority, const timespec* until) {
    Time deadline = kNever;
    if (!deadline_of(until, deadline)) return -1;
    return try_again([&] { return REAL(mq_timedsend)(queue, message, size, priority, &kAtOnce); }, ETIMEDOUT,
                     deadline, ETIMEDOUT);
}
}  // namespace

SHIM_EXPORT ssize_t mq_receive(mqd_t queue, char* message, size_t size, unsigned* priority) {
    if (!conducted() || queue_never_waits(queue)) return REAL(mq_receive)(queue, message, size, priority);
    return receive_message(queue, message, size, priority, nullptr);
}

SHIM_EXPORT ssize_t mq_timedreceive(mqd_t queue, char* message, size_t size, unsigned* priority,
                                    const timespec* until) {
    if (!conducted() || queue_never_waits(queue))
        return REAL(mq_timedreceive)(queue, message, size, priority, until);
    return receive_message(queue, message, size, priority, until);
}

SHIM_EXPORT int mq_send(mqd_t queue, const char* message, size_t size, unsigned priority) {
    if (!conducted() || queue_never_waits(queue)) return REAL(mq_send)(queue, message, size, priority);
    return send_message(queue, message, size, priority, nullptr);
}

SHIM_EXPORT int mq_timedsend(mqd_t queue, const char* message, size_t size, unsigned priority,
                             const timespec* until) {
    if (!conducted() || queue_never_waits(queue))
        return REAL(mq_timedsend)(queue, message, size, priority, until);
    return send_message(queue, message, size, priority, until);
}
