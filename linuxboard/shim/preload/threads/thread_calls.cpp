// Threads: created, joined, detached, cancelled, ended.

#include "linuxboard/shim/preload/host/direct_syscalls.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <pthread.h>
#include <sched.h>

#include <cerrno>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
pthread_key_t exit_key;

/// Runs in each round of the thread's destructors and hands the token on in the last one, so that destructors
/// of the program's own thread-specific data still run as part of the thread.
void thread_leaves(void* argument) {
    auto* thread = static_cast<Thread*>(argument);
    if (++thread->exit_rounds < PTHREAD_DESTRUCTOR_ITERATIONS) {
        pthread_setspecific(exit_key, thread);
        return;
    }
    if (active()) finish_thread(thread);
}

void* run_thread(void* argument) {
    auto* thread = static_cast<Thread*>(argument);
    pthread_setspecific(exit_key, thread);
    conduct_direct_syscalls();
    enter_thread(thread);
    return thread->start(thread->argument);
}

/// Waits in simulated time until `thread` has ended; ETIMEDOUT or 0.
int await_thread(Thread* thread, Time deadline) {
    mark_call("pthread_join");
    charge(page().charges.sync);
    while (thread->state != Thread::State::Finished) {
        WaitOptions options;
        options.deadline = deadline;
        options.interruptible = true;  // a handler runs, then the wait goes on
        options.cancellable = true;
        if (park(thread, options) == Wake::Timeout) return ETIMEDOUT;
    }
    return 0;
}
}  // namespace

void prepare_threads(Thread* main_thread) {
    pthread_key_create(&exit_key, thread_leaves);
    pthread_setspecific(exit_key, main_thread);
}

}  // namespace puckloop::shim

SHIM_EXPORT int pthread_create(pthread_t* handle, const pthread_attr_t* attributes, void* (*start)(void*),
                               void* argument) noexcept {
    if (!active()) return REAL(pthread_create)(handle, attributes, start, argument);
    mark_call("pthread_create");
    charge(page().charges.thread);
    Thread* thread = new_thread();
    if (thread == nullptr) {
        note("more than 1024 threads are not supported");
        return EAGAIN;
    }
    thread->start = start;
    thread->argument = argument;
    const int error = REAL(pthread_create)(handle, attributes, run_thread, thread);
    if (error != 0) {
        thread->state = Thread::State::Finished;
        return error;
    }
    thread->handle = *handle;
    thread->has_handle = true;
    return 0;
}

SHIM_EXPORT int pthread_join(pthread_t handle, void** result) {
    Thread* thread = active() ? find_thread(handle) : nullptr;
    if (thread == nullptr || thread == self()) return REAL(pthread_join)(handle, result);
    await_thread(thread, kNever);
    thread->has_handle = false;
    return REAL(pthread_join)(handle, result);
}

SHIM_EXPORT int pthread_tryjoin_np(pthread_t handle, void** result) noexcept {
    Thread* thread = active() ? find_thread(handle) : nullptr;
    if (thread == nullptr) return REAL(pthread_tryjoin_np)(handle, result);
    charge(page().charges.yield);
    if (thread->state != Thread::State::Finished) return EBUSY;
    thread->has_handle = false;
    return REAL(pthread_join)(handle, result);
}

SHIM_EXPORT int pthread_clockjoin_np(pthread_t handle, void** result, clockid_t clock,
                                     const timespec* limit) {
    Thread* thread = active() ? find_thread(handle) : nullptr;
    if (thread == nullptr) return REAL(pthread_clockjoin_np)(handle, result, clock, limit);
    const Time deadline = limit == nullptr ? kNever : absolute_deadline(clock, *limit);
    if (const int error = await_thread(thread, deadline)) return error;
    thread->has_handle = false;
    return REAL(pthread_join)(handle, result);
}

SHIM_EXPORT int pthread_timedjoin_np(pthread_t handle, void** result, const timespec* limit) {
    if (!active()) return REAL(pthread_timedjoin_np)(handle, result, limit);
    return pthread_clockjoin_np(handle, result, CLOCK_REALTIME, limit);
}

SHIM_EXPORT int pthread_cancel(pthread_t handle) {
    if (!active()) return REAL(pthread_cancel)(handle);
    charge(page().charges.sync);
    Thread* thread = find_thread(handle);
    const int error = REAL(pthread_cancel)(handle);
    if (error == 0 && thread != nullptr) cancel_thread(thread);
    return error;
}

SHIM_EXPORT int pthread_setcanceltype(int type, int* old) {
    if (type == PTHREAD_CANCEL_ASYNCHRONOUS && active())
        note("asynchronous cancellation acts as deferred cancellation");
    if (active()) {
        const int error = REAL(pthread_setcanceltype)(PTHREAD_CANCEL_DEFERRED, old);
        return error;
    }
    return REAL(pthread_setcanceltype)(type, old);
}

SHIM_EXPORT int sched_yield() noexcept {
    if (!active()) return REAL(sched_yield)();
    mark_call("sched_yield");
    charge(page().charges.yield);
    yield_token();
    return 0;
}
