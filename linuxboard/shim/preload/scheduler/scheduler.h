#pragma once
// The threads of the program, of which one runs at a time, and their common clock.
//
// A thread runs until it waits: for time, for a key (a mutex, a condition variable, a futex word, another
// thread) or for a device. Then the thread that became ready first goes on; of threads ready since the same
// simulated time, the one created first. A thread that keeps running gives way once another one has been
// ready for a quantum of simulated time.
//
// All state here belongs to the thread that runs (it holds "the token"), so nothing needs a lock.

#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/wire/wire.h"

#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>

namespace puckloop::shim {

namespace wire = linuxboard::wire;

using Time = std::int64_t;  ///< picoseconds
inline constexpr Time kNever = wire::kNever;
inline constexpr Time kNanosecond = 1'000;
inline constexpr Time kMicrosecond = 1'000'000;
inline constexpr Time kMillisecond = 1'000'000'000;
inline constexpr Time kSecond = 1'000'000'000'000;

enum class Wake { Key, Timeout, Device, Signal, Cancelled };

struct Thread {
    enum class State { Running, Ready, Parked, Device, Finished };

    std::uint32_t index = 0;
    State state = State::Ready;
    Time ready_since = 0;
    Time computed = 0;  ///< processor time: what its calls were charged
    const void* key = nullptr;
    std::uint64_t bits = ~std::uint64_t{0};  ///< of FUTEX_WAIT_BITSET
    Time deadline = kNever;
    std::uint64_t order = 0;  ///< of parking: who waits longest is woken first
    Wake wake = Wake::Key;
    bool interruptible = false;
    bool cancellable = false;
    bool cancel_asked = false;
    std::atomic<std::uint32_t> token{0};

    void* out = nullptr;  ///< where a device call's data goes
    std::size_t capacity = 0;
    std::size_t received = 0;
    std::int64_t result = 0;
    int error = 0;

    pthread_t handle{};
    bool has_handle = false;
    void* (*start)(void*) = nullptr;
    void* argument = nullptr;
    int exit_rounds = 0;
    bool restarts = true;  ///< after Wake::Signal: no handler that ran interrupts calls

    const sigset_t* awaited_signals = nullptr;  ///< sigwait
    int taken_signal = 0;
    std::uint64_t directed = 0;  ///< signals for this thread alone; bit n: signal n
    std::uint64_t blocked = 0;   ///< likewise: its mask when it last gave way
};

/// The library conducts this process and the calling thread. False before the start, in
/// processes the node does not know, and once the program has announced its end.
bool active();
Thread* self();

Time now();
/// A call that does not block: time passes, and other threads may get their turn.
void charge(Time cost);
/// The same of a lock, an unlock or a signal of one. A process with one thread has nobody to take it from,
/// and is charged nothing: how many locks a language's library takes depends on the host's files (Python
/// takes eight for each entry of a directory in which it looks for modules). So many in a row that time must
/// pass are charged all the same. True if it was charged.
bool charge_lock();
/// A lock is tried: one that is taken already is charged in any case.
template <class Attempt>
int try_lock(Attempt attempt) {
    const bool charged = charge_lock();
    const int result = attempt();
    const int error = errno;
    if (result != 0 && !charged) charge(page().charges.sync);
    errno = error;
    return result;
}
/// Gives way to every thread that is ready.
void yield_token();

struct WaitOptions {
    Time deadline = kNever;
    bool interruptible = false;  ///< a signal ends the wait
    bool cancellable = false;    ///< pthread_cancel ends the wait
    std::uint64_t bits = ~std::uint64_t{0};
};
/// Waits until woken by `key` or until the deadline.
Wake park(const void* key, const WaitOptions& options = {});
/// Wakes up to `count` threads parked on `key`, longest waiting first; returns how many.
int wake(const void* key, int count, std::uint64_t bits = ~std::uint64_t{0});

/// The key on which threads wait that watch descriptors outside.
const void* external_key();

/// One request to the node for the calling thread; blocks in simulated time if the device does. `size` bytes
/// from `data` go with it; up to `capacity` bytes of the answer's data come to `out`.
/// Returns the result (-1 with errno). A signal gives -1 with EINTR if `interruptible`.
std::int64_t device_call(wire::Request request, const void* data = nullptr, std::size_t size = 0,
                         void* out = nullptr, std::size_t capacity = 0, bool interruptible = false,
                         std::size_t* received = nullptr);

/// A line for the run's log and report; each text once.
void note(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// Names the call that is being made, for the node's watchdog.
void mark_call(const char* name);

/// The number of a thread of this process, as gettid() gives it.
pid_t thread_number(std::uint32_t index);
Thread* new_thread();
/// The one that runs the program's main(): it is there already, and runs.
Thread* adopt_main_thread();
void finish_thread(Thread* thread);
Thread* find_thread(pthread_t handle);
Thread* thread_at(std::size_t index);
std::size_t thread_count();
/// First thing that a new thread does: waits for its turn.
void enter_thread(Thread* thread);
void cancel_thread(Thread* thread);
/// A signal for `thread` alone, which is not the calling one: its handler runs on it when it goes on, and a
/// call that signals interrupt ends now.
void direct_signal(Thread* thread, int number);
/// A signal for this process from itself: the first thread that does not block it takes it; if that is the
/// calling one, before this returns.
void signal_process(int number);

void announce_exit(int status);
/// In a forked child: nothing is conducted any more.
void go_passive();
/// In a forked child of which the node knows: the calling thread is its only one, and it is conducted.
void only_this_thread();
/// First request of a process or a program; returns what its predecessor left for it.
std::string say_hello(bool forked);

}  // namespace puckloop::shim
