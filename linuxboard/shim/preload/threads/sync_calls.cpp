// Semaphores, barriers, pthread_once. See lock_calls.cpp.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <pthread.h>
#include <semaphore.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstring>

using namespace puckloop::shim;

namespace {
/// The C library keeps this beside the count (struct new_sem).
bool is_shared(const sem_t* semaphore) {
    int shared = 0;
    std::memcpy(&shared, semaphore->__size + sizeof(std::uint64_t), sizeof shared);
    return shared != 0;
}

int wait_semaphore(sem_t* semaphore, Time deadline) {
    mark_call("sem_wait");
    pthread_testcancel();
    charge_lock();
    while (REAL(sem_trywait)(semaphore) != 0) {
        if (errno != EAGAIN) return -1;
        if (deadline <= now()) return fail(ETIMEDOUT);
        WaitOptions options;
        options.deadline = deadline;
        options.interruptible = true;
        options.cancellable = true;
        const Wake reason = park_shared(semaphore, options, is_shared(semaphore));
        if (reason == Wake::Signal) return fail(EINTR);
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
    if (!active()) return REAL(sem_trywait)(semaphore);
    return try_lock([semaphore] { return REAL(sem_trywait)(semaphore); });
}

SHIM_EXPORT int sem_post(sem_t* semaphore) noexcept {
    const int result = REAL(sem_post)(semaphore);
    if (!active()) return result;
    wake(semaphore, 1);
    charge_lock();
    return result;
}

// pthread_once: its state is ours while threads wait.

namespace {
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

// Barriers: the memory of the C library's own object (struct pthread_barrier) has the state, which other
// processes may share.

namespace {
struct Barrier {
    std::uint32_t arrived, round, needed, shared, unused;
};
static_assert(sizeof(Barrier) <= sizeof(pthread_barrier_t));
}  // namespace

SHIM_EXPORT int pthread_barrier_destroy(pthread_barrier_t* object) noexcept {
    return active() ? 0 : REAL(pthread_barrier_destroy)(object);
}

SHIM_EXPORT int pthread_barrier_wait(pthread_barrier_t* object) noexcept {
    if (!active()) return REAL(pthread_barrier_wait)(object);
    mark_call("pthread_barrier_wait");
    charge_lock();
    auto* barrier = reinterpret_cast<Barrier*>(object);
    const std::uint32_t round = __atomic_load_n(&barrier->round, __ATOMIC_ACQUIRE);
    if (__atomic_add_fetch(&barrier->arrived, 1, __ATOMIC_ACQ_REL) >= barrier->needed) {
        __atomic_store_n(&barrier->arrived, 0, __ATOMIC_RELAXED);
        __atomic_store_n(&barrier->round, round + 1, __ATOMIC_RELEASE);
        wake(barrier, INT_MAX);
        return PTHREAD_BARRIER_SERIAL_THREAD;
    }
    while (__atomic_load_n(&barrier->round, __ATOMIC_ACQUIRE) == round)
        park_shared(barrier, {}, barrier->shared != 0);
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
