// Mutexes, condition variables, read-write locks, semaphores, barriers, pthread_once.
//
// The C library's own objects keep the state, through their try functions; only the waiting is ours.
// Deviation: objects shared between processes work within this one only.

#include "linuxboard/shim/preload/calls.h"
#include "linuxboard/shim/preload/host.h"
#include "linuxboard/shim/preload/real.h"
#include "linuxboard/shim/preload/scheduler.h"

#include <pthread.h>
#include <semaphore.h>
#include <sys/syscall.h>

#include <cerrno>
#include <climits>

using namespace puckloop::shim;

namespace {
/// Takes a lock by `attempt` (0 or EBUSY), waiting on `key` in between.
template <typename Attempt>
int lock_by(const void* key, Time deadline, Attempt attempt) {
    charge(page().charges.sync);
    while (true) {
        const int error = attempt();
        if (error != EBUSY) return error;
        if (deadline <= now()) return ETIMEDOUT;
        WaitOptions options;
        options.deadline = deadline;
        if (park(key, options) == Wake::Timeout) return attempt() == 0 ? 0 : ETIMEDOUT;
    }
}

int lock_mutex(pthread_mutex_t* mutex, Time deadline) {
    mark_call("pthread_mutex_lock");
    // An error-checking mutex that its owner locks again is busy to trylock, but a mistake to lock.
    constexpr int kKindMask = 3;
    if ((mutex->__data.__kind & kKindMask) == PTHREAD_MUTEX_ERRORCHECK_NP &&
        mutex->__data.__owner == static_cast<int>(host_call(SYS_gettid)))
        return EDEADLK;
    return lock_by(mutex, deadline, [mutex] { return REAL(pthread_mutex_trylock)(mutex); });
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

int wait_condition(pthread_cond_t* condition, pthread_mutex_t* mutex, Time deadline) {
    mark_call("pthread_cond_wait");
    charge(page().charges.sync);
    if (const int error = unlock_mutex(mutex)) return error;
    WaitOptions options;
    options.deadline = deadline;
    options.interruptible = true;  // a handler runs; the wake-up is then a spurious one
    options.cancellable = true;
    Relock again{mutex};
    Wake reason = Wake::Timeout;
    pthread_cleanup_push(relock, &again);  // a cancelled wait ends with the mutex held
    reason = park(condition, options);
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
    charge(page().charges.sync);
    return REAL(pthread_mutex_trylock)(mutex);
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
    charge(page().charges.sync);
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
    wake(condition, 1);
    charge(page().charges.sync);
    return 0;
}

SHIM_EXPORT int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
    if (!active()) return REAL(pthread_cond_broadcast)(condition);
    wake(condition, INT_MAX);
    charge(page().charges.sync);
    return 0;
}

SHIM_EXPORT int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_rwlock_rdlock)(lock);
    return lock_by(lock, kNever, [lock] { return REAL(pthread_rwlock_tryrdlock)(lock); });
}

SHIM_EXPORT int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_rwlock_wrlock)(lock);
    return lock_by(lock, kNever, [lock] { return REAL(pthread_rwlock_trywrlock)(lock); });
}

SHIM_EXPORT int pthread_rwlock_clockrdlock(pthread_rwlock_t* lock, clockid_t clock,
                                           const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_rwlock_clockrdlock)(lock, clock, limit);
    return lock_by(lock, absolute_deadline(clock, *limit),
                   [lock] { return REAL(pthread_rwlock_tryrdlock)(lock); });
}

SHIM_EXPORT int pthread_rwlock_clockwrlock(pthread_rwlock_t* lock, clockid_t clock,
                                           const timespec* limit) noexcept {
    if (!active()) return REAL(pthread_rwlock_clockwrlock)(lock, clock, limit);
    return lock_by(lock, absolute_deadline(clock, *limit),
                   [lock] { return REAL(pthread_rwlock_trywrlock)(lock); });
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
    if (active()) charge(page().charges.sync);
    return REAL(pthread_rwlock_tryrdlock)(lock);
}

SHIM_EXPORT int pthread_rwlock_trywrlock(pthread_rwlock_t* lock) noexcept {
    if (active()) charge(page().charges.sync);
    return REAL(pthread_rwlock_trywrlock)(lock);
}

SHIM_EXPORT int pthread_rwlock_unlock(pthread_rwlock_t* lock) noexcept {
    const int error = REAL(pthread_rwlock_unlock)(lock);
    if (!active()) return error;
    wake(lock, INT_MAX);
    charge(page().charges.sync);
    return error;
}

SHIM_EXPORT int pthread_spin_lock(pthread_spinlock_t* lock) noexcept {
    if (!active()) return REAL(pthread_spin_lock)(lock);
    return lock_by(const_cast<int*>(lock), kNever, [lock] { return REAL(pthread_spin_trylock)(lock); });
}

SHIM_EXPORT int pthread_spin_trylock(pthread_spinlock_t* lock) noexcept {
    if (active()) charge(page().charges.sync);
    return REAL(pthread_spin_trylock)(lock);
}

SHIM_EXPORT int pthread_spin_unlock(pthread_spinlock_t* lock) noexcept {
    const int error = REAL(pthread_spin_unlock)(lock);
    if (active()) wake(const_cast<int*>(lock), 1);
    return error;
}

// --- semaphores

namespace {
int wait_semaphore(sem_t* semaphore, Time deadline) {
    mark_call("sem_wait");
    pthread_testcancel();
    charge(page().charges.sync);
    while (REAL(sem_trywait)(semaphore) != 0) {
        if (errno != EAGAIN) return -1;
        if (deadline <= now()) {
            errno = ETIMEDOUT;
            return -1;
        }
        WaitOptions options;
        options.deadline = deadline;
        options.interruptible = true;
        options.cancellable = true;
        const Wake reason = park(semaphore, options);
        if (reason == Wake::Signal) {
            errno = EINTR;
            return -1;
        }
    }
    return 0;
}
}  // namespace

SHIM_EXPORT int sem_wait(sem_t* semaphore) {
    return active() ? wait_semaphore(semaphore, kNever) : REAL(sem_wait)(semaphore);
}

SHIM_EXPORT int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* limit) {
    if (!active()) return REAL(sem_clockwait)(semaphore, clock, limit);
    return wait_semaphore(semaphore, absolute_deadline(clock, *limit));
}

SHIM_EXPORT int sem_timedwait(sem_t* semaphore, const timespec* limit) {
    if (!active()) return REAL(sem_timedwait)(semaphore, limit);
    return sem_clockwait(semaphore, CLOCK_REALTIME, limit);
}

SHIM_EXPORT int sem_trywait(sem_t* semaphore) noexcept {
    if (active()) charge(page().charges.sync);
    return REAL(sem_trywait)(semaphore);
}

SHIM_EXPORT int sem_post(sem_t* semaphore) noexcept {
    const int result = REAL(sem_post)(semaphore);
    if (!active()) return result;
    wake(semaphore, 1);
    charge(page().charges.sync);
    return result;
}

// --- barriers and pthread_once: their state is ours while threads wait

namespace {
struct Barrier {
    pthread_barrier_t* object = nullptr;
    unsigned needed = 0;
    unsigned arrived = 0;
    unsigned round = 0;
};
constexpr int kMostBarriers = 64;
Barrier barriers[kMostBarriers];

Barrier* find_barrier(const pthread_barrier_t* object) {
    for (Barrier& barrier : barriers) {
        if (barrier.object == object) return &barrier;
    }
    return nullptr;
}

struct OnceRun {
    pthread_once_t* control = nullptr;
    Thread* runner = nullptr;
};
constexpr int kMostOnceRuns = 64;
OnceRun once_runs[kMostOnceRuns];

OnceRun* find_once(const pthread_once_t* control) {
    for (OnceRun& run : once_runs) {
        if (run.control == control) return &run;
    }
    return nullptr;
}
}  // namespace

SHIM_EXPORT int pthread_barrier_init(pthread_barrier_t* object, const pthread_barrierattr_t* attributes,
                                     unsigned count) noexcept {
    const int error = REAL(pthread_barrier_init)(object, attributes, count);
    if (error != 0 || !active()) return error;
    Barrier* barrier = find_barrier(object);
    if (barrier == nullptr) barrier = find_barrier(nullptr);
    if (barrier == nullptr) {
        note("more than %d barriers are not supported", kMostBarriers);
        return EAGAIN;
    }
    *barrier = {object, count, 0, 0};
    return 0;
}

SHIM_EXPORT int pthread_barrier_destroy(pthread_barrier_t* object) noexcept {
    if (Barrier* barrier = active() ? find_barrier(object) : nullptr) *barrier = {};
    return REAL(pthread_barrier_destroy)(object);
}

SHIM_EXPORT int pthread_barrier_wait(pthread_barrier_t* object) noexcept {
    Barrier* barrier = active() ? find_barrier(object) : nullptr;
    if (barrier == nullptr) return REAL(pthread_barrier_wait)(object);
    mark_call("pthread_barrier_wait");
    charge(page().charges.sync);
    if (++barrier->arrived == barrier->needed) {
        barrier->arrived = 0;
        ++barrier->round;
        wake(barrier, INT_MAX);
        return PTHREAD_BARRIER_SERIAL_THREAD;
    }
    for (const unsigned round = barrier->round; barrier->round == round;)
        park(barrier);
    return 0;
}

SHIM_EXPORT int pthread_once(pthread_once_t* control, void (*routine)()) {
    constexpr int kDone = 2;
    if (!active() || __atomic_load_n(control, __ATOMIC_ACQUIRE) == kDone)
        return REAL(pthread_once)(control, routine);
    while (const OnceRun* run = find_once(control)) {
        if (run->runner == self()) break;  // a routine that calls itself: hangs in the C library, as it would
        park(control);
    }
    OnceRun* run = find_once(nullptr);
    if (run == nullptr) return REAL(pthread_once)(control, routine);
    *run = {control, self()};
    const int error = REAL(pthread_once)(control, routine);
    *run = {};
    wake(control, INT_MAX);
    return error;
}
