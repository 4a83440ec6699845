// Signals of faults. This library's handler comes first: it ends a copy that met a bad pointer, counts faults
// that a program's own handler goes back to again and again, and hands on the rest as the kernel would.
// SIGSYS is one of them since system calls past the C library arrive by it (direct_syscalls.h).

#include "linuxboard/shim/preload/host/fault_signals.h"
#include "linuxboard/shim/preload/host/failure.h"

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/signal_origins.h"

#include <signal.h>
#include <sys/syscall.h>
#include <ucontext.h>

#include <cerrno>
#include <iterator>

namespace puckloop::shim {

namespace {
constexpr int kFaults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS};
constexpr int kDirectCall = 2;                ///< si_code SYS_USER_DISPATCH
struct sigaction wanted[std::size(kFaults)];  ///< what the program has set
bool guarding = false;
void (*direct_call)(void* context) = nullptr;
__thread sigjmp_buf* guard __attribute__((tls_model("initial-exec"))) = nullptr;

int index_of(int number) {
    for (std::size_t i = 0; guarding && i < std::size(kFaults); ++i)
        if (kFaults[i] == number) return static_cast<int>(i);
    return -1;
}

std::uint64_t place_of_fault(const void* context) {
    const auto& machine = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
    return static_cast<std::uint64_t>(machine.gregs[REG_RIP]);
#else
    return machine.pc;
#endif
}

/// For the node, should nothing else follow.
void count_fault(int number, const siginfo_t* info, const void* context) {
    wire::ProcessEntry& entry = own();
    const std::int64_t now = entry.now.load(std::memory_order_relaxed);
    if (entry.fault_signal != static_cast<std::uint32_t>(number) || entry.fault_time != now)
        entry.faults.store(0);
    entry.fault_signal = static_cast<std::uint32_t>(number);
    entry.fault_time = now;
    entry.fault_place = place_of_fault(context);
    entry.fault_address = reinterpret_cast<std::uint64_t>(info->si_addr);
    entry.faults.fetch_add(1);
}

void die_of(int number, const siginfo_t* info) {
    struct sigaction plain {};
    plain.sa_handler = SIG_DFL;
    REAL(sigaction)(number, &plain, nullptr);
    // A fault comes again when the handler returns; a signal that was sent has to be sent again.
    if (info->si_code <= 0) host_call(SYS_tgkill, host_call(SYS_getpid), host_call(SYS_gettid), number);
}

void on_fault(int number, siginfo_t* info, void* context) {
    if (number == SIGSYS && info->si_code == kDirectCall && direct_call != nullptr)
        return direct_call(context);
    const int error = errno;
    const bool is_fault = info->si_code > 0;
    if (guard != nullptr && is_fault && (number == SIGSEGV || number == SIGBUS)) {
        sigjmp_buf* const back = guard;
        guard = nullptr;
        siglongjmp(*back, 1);
    }
    const int index = index_of(number);
    const struct sigaction action = wanted[index];
    if (action.sa_handler == SIG_IGN && !is_fault) return;
    if (action.sa_handler == SIG_DFL || action.sa_handler == SIG_IGN) return die_of(number, info);
    count_fault(number, info, context);
    if ((action.sa_flags & static_cast<int>(SA_RESETHAND)) != 0) wanted[index].sa_handler = SIG_DFL;
    sigset_t blocked = action.sa_mask;
    if ((action.sa_flags & SA_NODEFER) == 0) sigaddset(&blocked, number);
    sigdelset(&blocked, SIGSYS);
    host_call(SYS_rt_sigprocmask, SIG_BLOCK, reinterpret_cast<long>(&blocked), 0, _NSIG / 8);
    errno = error;
    if ((action.sa_flags & SA_SIGINFO) != 0) {
        action.sa_sigaction(number, info, context);
    } else {
        action.sa_handler(number);
    }
}

void take_first(int number, const struct sigaction& action) {
    struct sigaction first {};
    first.sa_sigaction = on_fault;
    first.sa_flags = SA_SIGINFO | SA_NODEFER | (action.sa_flags & SA_RESTART);
    if (number != SIGSYS) first.sa_flags |= SA_ONSTACK;  // a call may need more than a program puts aside
    REAL(sigaction)(number, &first, nullptr);
}

sighandler_t set_handler(int number, sighandler_t handler, int flags) {
    struct sigaction action {
    }, before{};
    action.sa_handler = handler;
    action.sa_flags = flags;
    return sigaction(number, &action, &before) == 0 ? before.sa_handler : SIG_ERR;
}
}  // namespace

sigjmp_buf* set_fault_guard(sigjmp_buf* next) {
    sigjmp_buf* const before = guard;
    guard = next;
    return before;
}

void take_direct_calls(void (*handler)(void* context)) {
    direct_call = handler;
}

void guard_memory() {
    for (std::size_t i = 0; i < std::size(kFaults); ++i) {
        REAL(sigaction)(kFaults[i], nullptr, &wanted[i]);
        take_first(kFaults[i], wanted[i]);
    }
    guarding = true;
}

}  // namespace puckloop::shim

using namespace puckloop::shim;

SHIM_EXPORT int sigaction(int number, const struct sigaction* action, struct sigaction* before) noexcept {
    const int index = index_of(number);
    struct sigaction next {};
    if (action != nullptr && !get_from_program(next, action)) return -1;
    sigdelset(&next.sa_mask, SIGSYS);
    if (index < 0) {
        struct sigaction old {};
        if (set_informed_action(number, action != nullptr ? &next : nullptr, &old) != 0) return -1;
        return before == nullptr || put_to_program(before, old) ? 0 : -1;
    }
    if (before != nullptr && !put_to_program(before, wanted[index])) return -1;
    if (action == nullptr) return 0;
    wanted[index] = next;
    take_first(number, next);
    return 0;
}

extern "C" sighandler_t __sysv_signal(int number, sighandler_t handler) noexcept;

SHIM_EXPORT sighandler_t signal(int number, sighandler_t handler) noexcept {
    return index_of(number) < 0 ? REAL(signal)(number, handler) : set_handler(number, handler, SA_RESTART);
}

SHIM_EXPORT sighandler_t __sysv_signal(int number, sighandler_t handler) noexcept {
    return index_of(number) < 0 ? REAL(__sysv_signal)(number, handler)
                                : set_handler(number, handler, static_cast<int>(SA_RESETHAND) | SA_NODEFER);
}

// SIGSYS is never blocked: a system call past the C library would end the program.
SHIM_EXPORT int pthread_sigmask(int how, const sigset_t* set, sigset_t* before) noexcept {
    sigset_t next;
    if (set != nullptr && how != SIG_UNBLOCK) {
        if (!get_from_program(next, set)) return EFAULT;
        sigdelset(&next, SIGSYS);
        set = &next;
    }
    return REAL(pthread_sigmask)(how, set, before);
}

SHIM_EXPORT int sigprocmask(int how, const sigset_t* set, sigset_t* before) noexcept {
    const int error = pthread_sigmask(how, set, before);
    if (error == 0) return 0;
    return fail(error);
}
