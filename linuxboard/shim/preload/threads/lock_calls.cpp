// Mutexes, condition variables, read-write locks, spin locks.
//
// The C library's own objects keep the state, through their try functions; only the waiting is ours.
// Objects shared between processes are looked at every millisecond.

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <pthread.h>
#include <sys/syscall.h>

#include <cerrno>
#include <climits>
#include <cstdint>

using namespace puckloop::shim;

namespace {
/// Takes a lock by `attempt` (0 or EBUSY), waiting on `key` in between.
template <typename Attempt>
int lock_by(const void* key, Time deadline, Attempt attempt, bool shared = false) {
    charge_lock();
    while (true) {
        const int error = attempt();
        if (error != EBUSY) return error;
        if (deadline <= now()) return ETIMEDOUT;
        WaitOptions options;
        options.deadline = deadline;
        options.interruptible = true;  // a handler runs, then the wait goes on
        if (park_shared(key, options, shared) == Wake::Timeout) return attempt() == 0 ? 0 : ETIMEDOUT;
    }
}

int lock_mutex(pthread_mutex_t* mutex, Time deadline) {
    mark_call("pthread_mutex_lock");
    // An error-checking mutex that its owner locks again is busy to trylock, but a mistake to lock.
    constexpr int kKindMask = 3;
    if ((mutex->__data.__kind & kKindMask) == PTHREAD_MUTEX_ERRORCHECK_NP &&
        mutex->__data.__owner == static_cast<int>(host_call(SYS_gettid)))
        return EDEADLK;
    constexpr int kSharedBit = 128;
    return lock_by(
        mutex, deadline, [mutex] { return REAL(pthread_mutex_trylock)(mutex); },
        (mutex->__data.__kind & kSharedBit) != 0);
}

int unlock_mutex(pthread_mutex_t* mutex) {
    const int error = REAL(pthread_mutex_unlock)(mutex);
    if (error == 0) wake(mutex, 1);
    return error;
}

clockid_t condition_clock(const pthread_cond_t* condition) {
    constexpr unsigned kMonotonicBit = 2;
    return (condition->__data.__wrefs & kMonotonicBit) != 0 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

struct Relock {
    pthread_mutex_t* mutex;
};
void relock(void* argument) {
    lock_mutex(static_cast<Relock*>(argument)->mutex, kNever);
}

bool is_shared(const pthread_cond_t* condition) {
    constexpr unsigned kSharedBit = 1;
    return (condition->__data.__wrefs & kSharedBit) != 0;
}

/// In a condition that processes share: how often it was signalled. The C library, which counts its own waits
/// there, never waits here.
std::uint64_t* signals_of(pthread_cond_t* condition) {
    static_assert(sizeof condition->__data.__wseq == sizeof(std::uint64_t));
    return reinterpret_cast<std::uint64_t*>(&condition->__data.__wseq);
}

void signal_condition(pthread_cond_t* condition, int count) {
    if (is_shared(condition)) __atomic_add_fetch(signals_of(condition), 1, __ATOMIC_ACQ_REL);
    wake(condition, count);
    charge_lock();
}

int wait_condition(pthread_cond_t* condition, pthread_mutex_t* mutex, Time deadline) {
    mark_call("pthread_cond_wait");
    charge_lock();
    const bool shared = is_shared(condition);
    const std::uint64_t before = shared ? __atomic_load_n(signals_of(condition), __ATOMIC_ACQUIRE) : 0;
    if (const int error = unlock_mutex(mutex)) return error;
    WaitOptions options;
    options.deadline = deadline;
    options.interruptible = true;  // a handler runs; the wake-up is then a spurious one
    options.cancellable = true;
    Relock again{mutex};
    Wake reason = Wake::Timeout;
    pthread_cleanup_push(relock, &again);  // a cancelled wait ends with the mutex held
    do
        reason = park_shared(condition, options, shared);
    while (shared && reason == Wake::Key &&
           __atomic_load_n(signals_of(condition), __ATOMIC_ACQUIRE) == before);
    pthread_cleanup_pop(0);
    lock_mutex(mutex, kNever);
    return reason == Wake::Timeout ? ETIMEDOUT : 0;
}
}  // namespace

SHIM_EXPORT int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
    if (!active()) return REAL(pthread_mutex_lock)(mutex);
    return lock_mutex(mutex, kNever);
}

SHIM_EXPORT int pthread_mutex_trylock(pthread_mutex_t* mutex) noexcept {
    if (!active()) return REAL(pthread_mutex_trylock)(mutex);
    return try_lock([mutex] { return REAL(pthread_mutex_trylock)(mutex); });
}

SHIM_EXPORT int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock,
                                        const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_mutex_clocklock)(mutex, clock, limit);
    if (!is_valid(*limit)) return EINVAL;
    return lock_mutex(mutex, absolute_deadline(clock, *limit));
}

SHIM_EXPORT int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_mutex_timedlock)(mutex, limit);
    return pthread_mutex_clocklock(mutex, CLOCK_REALTIME, limit);
}

SHIM_EXPORT int pthread_mutex_unlock(pthread_mutex_t* mutex) noexcept {
    if (!active()) return REAL(pthread_mutex_unlock)(mutex);
    const int error = unlock_mutex(mutex);
    charge_lock();
    return error;
}

SHIM_EXPORT int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
    if (!active()) return REAL(pthread_cond_wait)(condition, mutex);
    return wait_condition(condition, mutex, kNever);
}

SHIM_EXPORT int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                                       const timespec* limit) {
    if (!active()) return REAL(pthread_cond_clockwait)(condition, mutex, clock, limit);
    if (!is_valid(*limit)) return EINVAL;
    return wait_condition(condition, mutex, absolute_deadline(clock, *limit));
}

SHIM_EXPORT int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                                       const timespec* limit) {
    if (!active()) return REAL(pthread_cond_timedwait)(condition, mutex, limit);
    return pthread_cond_clockwait(condition, mutex, condition_clock(condition), limit);
}

SHIM_EXPORT int pthread_cond_signal(pthread_cond_t* condition) noexcept {
    if (!active()) return REAL(pthread_cond_signal)(condition);
    signal_condition(condition, 1);
    return 0;
}

SHIM_EXPORT int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
    if (!active()) return REAL(pthread_cond_broadcast)(condition);
    signal_condition(condition, INT_MAX);
    return 0;
}

SHIM_EXPORT int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_rwlock_rdlock)(lock);
    return lock_by(
        lock, kNever, [lock] { return REAL(pthread_rwlock_tryrdlock)(lock); }, lock->__data.__shared != 0);
}

SHIM_EXPORT int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_rwlock_wrlock)(lock);
    return lock_by(
        lock, kNever, [lock] { return REAL(pthread_rwlock_trywrlock)(lock); }, lock->__data.__shared != 0);
}

SHIM_EXPORT int pthread_rwlock_clockrdlock(pthread_rwlock_t* lock, clockid_t clock,
                                           const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_rwlock_clockrdlock)(lock, clock, limit);
    return lock_by(
        lock, absolute_deadline(clock, *limit), [lock] { return REAL(pthread_rwlock_tryrdlock)(lock); },
        lock->__data.__shared != 0);
}

SHIM_EXPORT int pthread_rwlock_clockwrlock(pthread_rwlock_t* lock, clockid_t clock,
                                           const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_rwlock_clockwrlock)(lock, clock, limit);
    return lock_by(
        lock, absolute_deadline(clock, *limit), [lock] { return REAL(pthread_rwlock_trywrlock)(lock); },
        lock->__data.__shared != 0);
}

SHIM_EXPORT int pthread_rwlock_timedrdlock(pthread_rwlock_t* lock, const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_rwlock_timedrdlock)(lock, limit);
    return pthread_rwlock_clockrdlock(lock, CLOCK_REALTIME, limit);
}

SHIM_EXPORT int pthread_rwlock_timedwrlock(pthread_rwlock_t* lock, const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_rwlock_timedwrlock)(lock, limit);
    return pthread_rwlock_clockwrlock(lock, CLOCK_REALTIME, limit);
}

SHIM_EXPORT int pthread_rwlock_tryrdlock(pthread_rwlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_rwlock_tryrdlock)(lock);
    return try_lock([lock] { return REAL(pthread_rwlock_tryrdlock)(lock); });
}

SHIM_EXPORT int pthread_rwlock_trywrlock(pthread_rwlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_rwlock_trywrlock)(lock);
    return try_lock([lock] { return REAL(pthread_rwlock_trywrlock)(lock); });
}

SHIM_EXPORT int pthread_rwlock_unlock(pthread_rwlock_t* lock) noexcept {
    const int error = REAL(pthread_rwlock_unlock)(lock);
    if (!active()) return error;
    wake(lock, INT_MAX);
    charge_lock();
    return error;
}

SHIM_EXPORT int pthread_spin_lock(pthread_spinlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_spin_lock)(lock);
    return lock_by(const_cast<int*>(lock), kNever, [lock] { return REAL(pthread_spin_trylock)(lock); });
}

SHIM_EXPORT int pthread_spin_trylock(pthread_spinlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_spin_trylock)(lock);
    return try_lock([lock] { return REAL(pthread_spin_trylock)(lock); });
}

SHIM_EXPORT int pthread_spin_unlock(pthread_spinlock_t* lock) noexcept {
    const int error = REAL(pthread_spin_unlock)(lock);
    if (active()) wake(const_cast<int*>(lock), 1);
    return error;
}
