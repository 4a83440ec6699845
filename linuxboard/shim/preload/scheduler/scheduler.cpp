#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/host/failure.h"

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/scheduler/ahead.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/signal_origins.h"
#include "linuxboard/shim/preload/scheduler/timers.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <utility>

namespace puckloop::shim {

namespace {
constexpr std::size_t kMaximumThreads = 1024;
/// How long a ready thread waits at most while another keeps running without blocking.
constexpr Time kQuantum = 50 * kMicrosecond;
/// Locks in a row that a process with one thread takes in no time. Python's import takes some ten thousand;
/// whoever takes more and does nothing else waits for a signal or for another process.
constexpr std::uint64_t kMostFreeLocks = 1'000'000;
constexpr std::size_t kNoteLength = 400;
constexpr std::size_t kMaximumNotes = 100;

Thread* threads[kMaximumThreads];
std::size_t thread_total = 0;
Time clock_now = 0;
Time clock_limit = 0;
std::uint64_t park_order = 0;
std::uint64_t free_locks = 0;       // in a row
std::uint64_t pending_signals = 0;  // bit n: signal n
std::uint64_t from_node = 0;        // of those, with an origin that is known there
bool conducted = false;
bool in_node_call = false;

std::uint64_t hash_of(const char* text, std::size_t size) {
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
    for (std::size_t i = 0; i < size; ++i)
        hash = (hash ^ static_cast<unsigned char>(text[i])) * 0x100000001b3u;
    return hash;
}

__thread Thread* current __attribute__((tls_model("initial-exec"))) = nullptr;

/// Real-time mode: simulated time is never behind the wall clock.
void follow_wall_clock() {
    if (page().real_time == 0 || page().wall_origin == 0) return;
    clock_now = std::max(clock_now, (host_nanoseconds() - page().wall_origin) * kNanosecond);
}

void publish() {
    own().now.store(clock_now, std::memory_order_relaxed);
    own().thread.store(current != nullptr ? current->index : 0, std::memory_order_relaxed);
}

void make_ready(Thread& thread, Time since, Wake reason) {
    thread.state = Thread::State::Ready;
    thread.ready_since = since;
    thread.wake = reason;
    thread.key = nullptr;
    thread.deadline = kNever;
}

Thread* first_ready() {
    Thread* best = nullptr;
    for (std::size_t i = 0; i < thread_total; ++i) {
        Thread* thread = threads[i];
        if (thread == nullptr || thread->state != Thread::State::Ready) continue;
        if (best == nullptr || thread->ready_since < best->ready_since) best = thread;
    }
    return best;
}

Time first_deadline() {
    Time first = kNever;
    for (std::size_t i = 0; i < thread_total; ++i) {
        const Thread* thread = threads[i];
        if (thread != nullptr && thread->state == Thread::State::Parked)
            first = std::min(first, thread->deadline);
    }
    return std::min(first, next_timer());
}

void expire_deadlines() {
    if (next_timer() <= clock_now) pending_signals |= fire_timers(clock_now);
    for (std::size_t i = 0; i < thread_total; ++i) {
        Thread* thread = threads[i];
        if (thread != nullptr && thread->state == Thread::State::Parked && thread->deadline <= clock_now)
            make_ready(*thread, thread->deadline, Wake::Timeout);
    }
}

void complete(const wire::Completion& completion, const char* data) {
    Thread* thread = completion.thread < thread_total ? threads[completion.thread] : nullptr;
    if (thread == nullptr || thread->state != Thread::State::Device) return;
    thread->result = completion.result;
    thread->error = completion.error;
    thread->received = std::min<std::size_t>(completion.length, thread->capacity);
    if (!copy_to_program(thread->out, data, thread->received)) {
        thread->result = -1;
        thread->error = EFAULT;
    }
    make_ready(*thread, completion.time, Wake::Device);
}

bool is_awaited(int signal) {
    for (std::size_t i = 0; i < thread_total; ++i) {
        const Thread* thread = threads[i];
        if (thread != nullptr && thread->awaited_signals != nullptr &&
            sigismember(thread->awaited_signals, signal) == 1)
            return true;
    }
    return false;
}

/// A thread waits for what another process may do.
bool watches() {
    for (std::size_t i = 0; i < thread_total; ++i) {
        const Thread* thread = threads[i];
        if (thread != nullptr && thread->state == Thread::State::Parked && thread->key == external_key())
            return true;
    }
    return false;
}

Thread* signal_taker(int number);

/// Those of `signals` that come to nothing: they interrupt no call.
std::uint64_t ignored_signals(std::uint64_t signals) {
    constexpr std::uint64_t kIgnoredByDefault = std::uint64_t{1} << SIGCHLD | std::uint64_t{1} << SIGCONT |
                                                std::uint64_t{1} << SIGURG | std::uint64_t{1} << SIGWINCH;
    std::uint64_t ignored = 0;
    for (int number = 1; number < NSIG; ++number) {
        const std::uint64_t bit = std::uint64_t{1} << number;
        if ((signals & bit) == 0 || is_awaited(number)) continue;
        // One that is blocked is never ignored: sigwait() or a signalfd() may take it.
        if (thread_total > 0 && signal_taker(number) == nullptr) continue;
        struct sigaction action {};
        sigaction(number, nullptr, &action);
        const bool by_default = action.sa_handler == SIG_DFL && (kIgnoredByDefault & bit) != 0;
        if (action.sa_handler == SIG_IGN || by_default) ignored |= bit;
    }
    return ignored;
}

/// Sends a request and takes in the reply: time, completions, a signal.
void transact(wire::Request& request, const void* data, std::size_t size) {
    follow_wall_clock();
    request.now = clock_now;
    request.wait =
        first_ready() == nullptr && (current == nullptr || current->state != Thread::State::Running);
    request.wait_until = first_deadline();
    request.watches = request.wait != 0 && watches() ? 1 : 0;
    publish();
    wire::Reply reply;
    in_node_call = true;
    exchange(request, data, size, reply, complete);
    in_node_call = false;
    clock_now = reply.now;
    clock_limit = reply.limit;
    follow_wall_clock();
    if (reply.signals != 0) {
        const std::uint64_t taken = reply.signals & ~ignored_signals(reply.signals);
        pending_signals |= taken;
        from_node |= taken;
    }
    if (reply.changed != 0) wake(external_key(), INT32_MAX);
    expire_deadlines();
}

/// Of the calling thread, as the host has it; bit n: signal n.
std::uint64_t own_mask() {
    sigset_t set;
    sigemptyset(&set);
    pthread_sigmask(SIG_BLOCK, nullptr, &set);
    std::uint64_t mask = 0;
    for (int number = 1; number < NSIG; ++number)
        if (sigismember(&set, number) == 1) mask |= std::uint64_t{1} << number;
    return mask;
}

/// The main thread takes signals, as the kernel prefers, or the first after it that is left and does not
/// block this one; nullptr if all do.
Thread* signal_taker(int number) {
    for (std::size_t i = 0; i < thread_total; ++i) {
        if (threads[i] == nullptr || threads[i]->state == Thread::State::Finished) continue;
        const std::uint64_t blocked = threads[i] == current ? own_mask() : threads[i]->blocked;
        if ((blocked >> number & 1) == 0) return threads[i];
    }
    return nullptr;
}

/// Those that the calling thread has to take.
std::uint64_t due_signals() {
    std::uint64_t due = current->directed;
    for (std::uint64_t left = pending_signals; left != 0; left &= left - 1) {
        const int number = std::countr_zero(left);
        const Thread* taker = signal_taker(number);
        if (taker == nullptr || taker == current) due |= std::uint64_t{1} << number;
    }
    return due;
}

bool signals_due() {
    return (pending_signals | current->directed) != 0 && due_signals() != 0;
}

/// Time passes until `time`, at which a thread goes on, if the node has said that nothing happens before. In
/// real time the node paces it.
bool sleep_here(Time time) {
    if (time >= clock_limit || page().real_time != 0 || page().ask_always != 0) return false;
    clock_now = time;
    publish();
    ++channel().answered;
    return true;
}

/// The calling thread's request is answered without the node.
bool answer_here(const wire::Request& request, const void* data, std::size_t size) {
    Thread* me = current;
    Answer answer;
    if (clock_now >= clock_limit ||
        !answer_ahead(request, data, size, me->out, me->capacity, clock_now, answer))
        return false;
    if (answer.time > clock_now) {
        // Nobody else may run meanwhile, and change what the answer depends on.
        if (first_ready() != nullptr || first_deadline() <= answer.time) return false;
        if (!sleep_here(answer.time)) return false;
    } else {
        ++channel().answered;
    }
    me->result = answer.result;
    me->error = answer.error;
    me->received = answer.received;
    make_ready(*me, clock_now, Wake::Device);
    return true;
}

void withdraw(Thread& thread) {
    wire::Request request;
    request.op = wire::Op::Cancel;
    request.thread = thread.index;
    thread.state = Thread::State::Ready;
    transact(request, nullptr, 0);
}

/// A signal ends what the thread waits in, if signals do.
void interrupt(Thread& thread) {
    if (!thread.interruptible) return;
    // Its call has ended already: what it received is not lost, and the handler runs before it returns.
    const bool has_ended = thread.state == Thread::State::Ready && thread.wake == Wake::Device;
    if (has_ended && page().networked != 0) return;
    if (thread.state == Thread::State::Device) withdraw(thread);
    if (thread.state == Thread::State::Parked || thread.state == Thread::State::Ready)
        make_ready(thread, clock_now, Wake::Signal);
}

bool has_directed() {
    for (std::size_t i = 0; i < thread_total; ++i)
        if (threads[i] != nullptr && threads[i]->directed != 0) return true;
    return false;
}

void route_signal() {
    if (pending_signals == 0 && !has_directed()) return;
    for (std::size_t i = 0; i < thread_total; ++i) {
        Thread* thread = threads[i];
        if (thread == nullptr || thread->awaited_signals == nullptr) continue;
        for (int number = 1; number < NSIG; ++number) {
            const std::uint64_t bit = std::uint64_t{1} << number;
            if ((pending_signals & bit) == 0 || sigismember(thread->awaited_signals, number) != 1) continue;
            pending_signals &= ~bit;
            if ((from_node & bit) == 0) own().origins[number] = {};  // an alarm's
            from_node &= ~bit;
            thread->taken_signal = number;
            thread->awaited_signals = nullptr;
            make_ready(*thread, clock_now, Wake::Signal);
            break;
        }
    }
    for (std::uint64_t left = pending_signals; left != 0; left &= left - 1) {
        const int number = std::countr_zero(left);
        if (Thread* taker = signal_taker(number)) {
            interrupt(*taker);
            continue;
        }
        // All block it: it is kept by the host, for sigpending(), sigwait() and the one that unblocks it.
        const std::uint64_t bit = std::uint64_t{1} << number;
        pending_signals &= ~bit;
        if ((from_node & bit) != 0) expect_origin(number);
        from_node &= ~bit;
        host_call(SYS_kill, host_call(SYS_getpid), number);
        external_changed();  // a signalfd() is readable
    }
    for (std::size_t i = 0; i < thread_total; ++i)
        if (threads[i] != nullptr && (threads[i]->directed & ~threads[i]->blocked) != 0)
            interrupt(*threads[i]);
}

void hand_over(Thread* next) {
    next->state = Thread::State::Running;
    next->token.store(1, std::memory_order_release);
    host_futex_wake(&next->token);
}

void await_token(Thread* thread) {
    while (thread->token.load(std::memory_order_acquire) == 0)
        host_futex_wait(&thread->token, 0);
    thread->token.store(0, std::memory_order_relaxed);
}

/// The calling thread has just left the state Running. Returns when it runs again.
void schedule(Thread* me) {
    if (thread_total > 1 && me->state != Thread::State::Finished) me->blocked = own_mask();
    while (true) {
        expire_deadlines();
        route_signal();
        Thread* next = first_ready();
        if (next == me && me->state == Thread::State::Ready) {
            me->state = Thread::State::Running;
            publish();
            return;
        }
        if (next != nullptr) {
            hand_over(next);
            if (me->state == Thread::State::Finished) return;
            await_token(me);
            publish();
            return;
        }
        if (sleep_here(first_deadline())) continue;
        wire::Request request;
        request.thread = me->index;
        transact(request, nullptr, 0);
    }
}

/// Runs the handlers of the signals that are due, here and now. True if the interrupted call is to be
/// restarted: none of them interrupts.
bool take_signals() {
    bool restarts = true;
    for (std::uint64_t due = due_signals(); due != 0; due = due_signals()) {
        const int number = std::countr_zero(due);
        const std::uint64_t bit = std::uint64_t{1} << number;
        const bool directed = (current->directed & bit) != 0;
        (directed ? current->directed : pending_signals) &= ~bit;
        struct sigaction action {};
        sigaction(number, nullptr, &action);
        const bool ignored = action.sa_handler == SIG_IGN;
        sigset_t blocked;
        pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
        publish();
        if (!directed && (from_node & bit) != 0) expect_origin(number);
        if (!directed) from_node &= ~bit;
        if (sigismember(&blocked, number) == 1) {
            // Kept by the host until it is unblocked or waited for.
            if (directed) {
                host_call(SYS_tgkill, host_call(SYS_getpid), host_call(SYS_gettid), number);
            } else {
                host_call(SYS_kill, host_call(SYS_getpid), number);
            }
            continue;
        }
        raise(number);
        forget_origin(number);
        restarts = restarts && (ignored || (action.sa_flags & SA_RESTART) != 0);
    }
    return restarts;
}

void after_wait(Thread* me) {
    me->interruptible = false;
    if (me->cancellable && me->cancel_asked) {
        me->cancellable = false;
        pthread_testcancel();
    }
    me->cancellable = false;
}
}  // namespace

bool active() {
    // A handler of a signal from outside may run while its thread waits or asks: its calls go to the host.
    return conducted && current != nullptr && current->state == Thread::State::Running && !in_node_call;
}
Thread* self() {
    return current;
}
Time now() {
    follow_wall_clock();
    return clock_now;
}
std::size_t thread_count() {
    return thread_total;
}
Thread* thread_at(std::size_t index) {
    return threads[index];
}

void mark_call(const char* name) {
    std::strncpy(own().call_name, name, sizeof own().call_name - 1);
}

void yield_token() {
    Thread* me = current;
    make_ready(*me, clock_now, Wake::Key);
    // Those ready at this very time go first, whatever their index.
    me->ready_since = clock_now + 1;
    schedule(me);
}

namespace {
bool is_alone() {
    std::size_t living = 0;
    for (std::size_t i = 0; i < thread_total && living < 2; ++i)
        living += threads[i] != nullptr && threads[i]->state != Thread::State::Finished ? 1 : 0;
    return living < 2;
}

void pass_time(Time cost) {
    Thread* me = current;
    clock_now += cost;
    me->computed += cost;
    own().computed += cost;
    follow_wall_clock();
    publish();
    if (clock_now >= clock_limit) {
        wire::Request request;
        request.thread = me->index;
        transact(request, nullptr, 0);
    } else {
        expire_deadlines();
    }
    while (signals_due())
        take_signals();
    const Thread* other = first_ready();
    if (other != nullptr && clock_now - other->ready_since >= kQuantum) {
        make_ready(*me, clock_now, Wake::Key);
        schedule(me);
    }
}
}  // namespace

void charge(Time cost) {
    free_locks = 0;
    pass_time(cost);
}

bool charge_lock() {
    if (free_locks < kMostFreeLocks && is_alone()) {
        ++free_locks;
        return false;
    }
    pass_time(page().charges.sync);
    return true;
}

Wake park(const void* key, const WaitOptions& options) {
    Thread* me = current;
    if (options.cancellable && me->cancel_asked) pthread_testcancel();
    me->state = Thread::State::Parked;
    me->key = key;
    me->bits = options.bits;
    me->deadline = options.deadline;
    me->order = ++park_order;
    me->interruptible = options.interruptible;
    me->cancellable = options.cancellable;
    schedule(me);
    const Wake reason = me->wake;
    after_wait(me);
    if (reason == Wake::Signal) me->restarts = take_signals();
    return reason;
}

int wake(const void* key, int count, std::uint64_t bits) {
    int woken = 0;
    while (woken < count) {
        Thread* longest = nullptr;
        for (std::size_t i = 0; i < thread_total; ++i) {
            Thread* thread = threads[i];
            if (thread == nullptr || thread->state != Thread::State::Parked || thread->key != key) continue;
            if ((thread->bits & bits) == 0) continue;
            if (longest == nullptr || thread->order < longest->order) longest = thread;
        }
        if (longest == nullptr) break;
        make_ready(*longest, clock_now, Wake::Key);
        ++woken;
    }
    return woken;
}

std::int64_t device_call(wire::Request request, const void* data, std::size_t size, void* out,
                         std::size_t capacity, bool interruptible, std::size_t* received) {
    Thread* me = current;
    while (true) {
        if (interruptible && me->cancel_asked) pthread_testcancel();
        if (signals_due() && !take_signals() && interruptible) return fail(EINTR);
        me->state = Thread::State::Device;
        me->out = out;
        me->capacity = capacity;
        me->received = 0;
        me->interruptible = interruptible;
        me->cancellable = interruptible;
        request.thread = me->index;
        const Time before = clock_now;
        if (!answer_here(request, data, size)) transact(request, data, size);
        const Thread* other = first_ready();
        const bool at_once = me->state == Thread::State::Ready && me->ready_since == before;
        if (at_once && (other == me || before - other->ready_since < kQuantum)) {
            me->state = Thread::State::Running;
        } else {
            schedule(me);
        }
        const Wake reason = me->wake;
        const std::int64_t result = me->result;
        const int error = me->error;
        if (received != nullptr) *received = me->received;
        after_wait(me);
        if (reason == Wake::Signal) {
            // poll() is never restarted; what a handler wrote into a pipe is seen by the next one.
            const bool ends = request.op == wire::Op::Poll && page().networked != 0;
            if (take_signals() && !ends) continue;
            return fail(EINTR);
        }
        const bool signalled = signals_due();
        while (signals_due())
            take_signals();
        // A wait that ended without news at the very time of an alarm was ended by it.
        if (signalled && interruptible && result == 0 && request.op == wire::Op::Poll &&
            page().networked != 0)
            return fail(EINTR);
        if (result < 0) errno = error;
        return result;
    }
}

void note(const char* format, ...) {
    static std::uint64_t said[kMaximumNotes];
    static std::size_t said_total = 0;
    char text[kNoteLength];
    std::va_list arguments;
    va_start(arguments, format);
    const int length = std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length <= 0 || !active()) return;
    const std::size_t size = std::min<std::size_t>(static_cast<std::size_t>(length), sizeof text - 1);
    const std::uint64_t hash = hash_of(text, size);
    for (std::size_t i = 0; i < said_total; ++i) {
        if (said[i] == hash) return;
    }
    if (said_total == kMaximumNotes) return;
    said[said_total++] = hash;
    wire::Request request;
    request.op = wire::Op::Note;
    request.thread = current->index;
    transact(request, text, size);
}

Thread* new_thread() {
    if (thread_total == kMaximumThreads) return nullptr;
    auto* thread = new Thread;
    thread->index = static_cast<std::uint32_t>(thread_total);
    thread->ready_since = clock_now;
    if (current != nullptr) thread->blocked = own_mask();  // it inherits the mask
    threads[thread_total++] = thread;
    return thread;
}

void enter_thread(Thread* thread) {
    current = thread;
    await_token(thread);
    publish();
}

void finish_thread(Thread* thread) {
    thread->state = Thread::State::Finished;
    wake(thread, INT32_MAX);
    for (std::size_t i = 0; i < thread_total; ++i) {
        if (threads[i] != nullptr && threads[i]->state != Thread::State::Finished) {
            schedule(thread);
            current = nullptr;
            return;
        }
    }
    thread->state = Thread::State::Running;  // the last one: the C library ends the process from here
}

Thread* find_thread(pthread_t handle) {
    for (std::size_t i = thread_total; i-- > 0;) {
        if (threads[i] != nullptr && threads[i]->has_handle && pthread_equal(threads[i]->handle, handle) != 0)
            return threads[i];
    }
    return nullptr;
}

void cancel_thread(Thread* thread) {
    thread->cancel_asked = true;
    if (!thread->cancellable) return;
    if (thread->state == Thread::State::Device) withdraw(*thread);
    if (thread->state == Thread::State::Parked || thread->state == Thread::State::Ready)
        make_ready(*thread, clock_now, Wake::Cancelled);
}

void direct_signal(Thread* thread, int number) {
    const std::uint64_t bit = std::uint64_t{1} << number;
    const std::uint64_t blocked = thread == current ? own_mask() : thread->blocked;
    if ((blocked & bit) == 0 && ignored_signals(bit) != 0) return;
    if (thread->awaited_signals != nullptr && sigismember(thread->awaited_signals, number) == 1) {
        own().origins[number] = {own().number, 0, 0};
        thread->taken_signal = number;
        thread->awaited_signals = nullptr;
        return make_ready(*thread, clock_now, Wake::Signal);
    }
    thread->directed |= bit;
    if ((thread->blocked & bit) == 0) interrupt(*thread);
}

void signal_process(int number) {
    const std::uint64_t bit = std::uint64_t{1} << number;
    if (ignored_signals(bit) != 0) return;
    own().origins[number] = {own().number, 0, 0};
    pending_signals |= bit;
    from_node |= bit;
    route_signal();
    while (signals_due())
        take_signals();
}

void announce_exit(int status) {
    if (!active()) return;
    wire::Request request;
    request.op = wire::Op::Exit;
    request.thread = current->index;
    request.a = static_cast<std::uint32_t>(status);
    request.now = clock_now;
    publish();
    send_only(request);
    conducted = false;
}

void go_passive() {
    conducted = false;
}

void only_this_thread() {
    Thread* me = current;
    std::fill(std::begin(threads), std::end(threads), nullptr);
    threads[0] = me;
    thread_total = 1;
    me->index = 0;
    me->state = Thread::State::Running;
    me->awaited_signals = nullptr;
    me->directed = 0;
    me->computed = 0;
    pending_signals = 0;
    in_node_call = false;
    conducted = true;
}

std::string say_hello(bool forked) {
    std::string inherited(wire::kMaximumData, '\0');
    wire::Request request;
    request.op = wire::Op::Hello;
    request.a = wire::kVersion;
    request.b = forked ? 1 : 0;
    std::size_t received = 0;
    // From here on and not before: a sanitizer's allocator makes calls of its own, and Hello comes first.
    conducted = true;
    device_call(request, nullptr, 0, inherited.data(), inherited.size(), false, &received);
    inherited.resize(received);
    // The node, which by now is the parent of every process here, takes them along when it ends.
    host_call(SYS_prctl, PR_SET_PDEATHSIG, SIGKILL);
    return inherited;
}

Thread* adopt_main_thread() {
    Thread* main_thread = new_thread();
    main_thread->handle = pthread_self();
    main_thread->has_handle = true;
    main_thread->state = Thread::State::Running;
    current = main_thread;
    return main_thread;
}

const void* external_key() {
    static const char key = 0;
    return &key;
}

pid_t thread_number(std::uint32_t index) {
    // Beside the first thread's, which is the process's, they are far from all process numbers.
    constexpr pid_t kFirstThread = 100'000;
    constexpr pid_t kThreadsOfProcess = 1024;
    return index == 0 ? own().number
                      : kFirstThread + kThreadsOfProcess * (own().number - wire::kFirstProcess) +
                            static_cast<pid_t>(index);
}

}  // namespace puckloop::shim
