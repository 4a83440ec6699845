// The threads of C11. The C library's own reach its locks and waits inside, past any library that is
// preloaded; here they are those of POSIX, on which its objects are built too (mtx_t is a pthread_mutex_t,
// cnd_t a pthread_cond_t, once_flag a pthread_once_t).

#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <pthread.h>
#include <threads.h>
#include <time.h>

#include <cerrno>
#include <cstdint>
#include <new>

using namespace puckloop::shim;

namespace {
struct Beginning {
    thrd_start_t start;
    void* argument;
};

void* begin_thread(void* given) {
    const Beginning beginning = *static_cast<Beginning*>(given);
    delete static_cast<Beginning*>(given);
    return reinterpret_cast<void*>(static_cast<std::intptr_t>(beginning.start(beginning.argument)));
}

int code_of(int error) {
    switch (error) {
    case 0:
        return thrd_success;
    case ENOMEM:
        return thrd_nomem;
    case ETIMEDOUT:
        return thrd_timedout;
    case EBUSY:
        return thrd_busy;
    default:
        return thrd_error;
    }
}

pthread_mutex_t* posix(mtx_t* mutex) {
    return reinterpret_cast<pthread_mutex_t*>(mutex);
}
pthread_cond_t* posix(cnd_t* condition) {
    return reinterpret_cast<pthread_cond_t*>(condition);
}
}  // namespace

SHIM_EXPORT int thrd_create(thrd_t* handle, thrd_start_t start, void* argument) {
    if (!active()) return REAL(thrd_create)(handle, start, argument);
    auto* beginning = new (std::nothrow) Beginning{start, argument};
    if (beginning == nullptr) return thrd_nomem;
    const int error = pthread_create(handle, nullptr, begin_thread, beginning);
    if (error != 0) delete beginning;
    return code_of(error);
}

SHIM_EXPORT int thrd_join(thrd_t handle, int* result) {
    void* given = nullptr;
    const int error = pthread_join(handle, &given);
    if (error == 0 && result != nullptr) *result = static_cast<int>(reinterpret_cast<std::intptr_t>(given));
    return code_of(error);
}

SHIM_EXPORT void thrd_yield() {
    sched_yield();
}

/// -1 if a signal cut it short, another negative number for a time that is none.
SHIM_EXPORT int thrd_sleep(const timespec* time, timespec* left) {
    constexpr int kInvalid = -2;
    const int error = clock_nanosleep(CLOCK_REALTIME, 0, time, left);
    return error == 0 ? 0 : error == EINTR ? -1 : kInvalid;
}

SHIM_EXPORT int mtx_lock(mtx_t* mutex) {
    return code_of(pthread_mutex_lock(posix(mutex)));
}
SHIM_EXPORT int mtx_timedlock(mtx_t* mutex, const timespec* limit) {
    return code_of(pthread_mutex_timedlock(posix(mutex), limit));
}
SHIM_EXPORT int mtx_trylock(mtx_t* mutex) {
    return code_of(pthread_mutex_trylock(posix(mutex)));
}
SHIM_EXPORT int mtx_unlock(mtx_t* mutex) {
    return code_of(pthread_mutex_unlock(posix(mutex)));
}
SHIM_EXPORT int cnd_wait(cnd_t* condition, mtx_t* mutex) {
    return code_of(pthread_cond_wait(posix(condition), posix(mutex)));
}
SHIM_EXPORT int cnd_timedwait(cnd_t* condition, mtx_t* mutex, const timespec* limit) {
    return code_of(pthread_cond_timedwait(posix(condition), posix(mutex), limit));
}
SHIM_EXPORT int cnd_signal(cnd_t* condition) {
    return code_of(pthread_cond_signal(posix(condition)));
}
SHIM_EXPORT int cnd_broadcast(cnd_t* condition) {
    return code_of(pthread_cond_broadcast(posix(condition)));
}
SHIM_EXPORT void call_once(once_flag* flag, void (*routine)()) {
    pthread_once(reinterpret_cast<pthread_once_t*>(flag), routine);
}
