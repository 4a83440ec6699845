#include "linuxboard/shim/preload/scheduler/signal_origins.h"

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

namespace puckloop::shim {

namespace {
using Handler = void (*)(int, siginfo_t*, void*);
Handler handlers[NSIG];           ///< the program's
volatile sig_atomic_t due[NSIG];  ///< the node's, on their way

/// What the host states of a signal's sender, as it is on the board.
void translate(int number, siginfo_t& info) {
    const bool sent = info.si_code == SI_USER || info.si_code == SI_TKILL || info.si_code == SI_QUEUE;
    if (!active() || !sent) return;
    if (due[number] != 0) {
        due[number] = 0;
        return show_origin(number, info);
    }
    info.si_uid = getuid();
    info.si_pid = info.si_pid == static_cast<pid_t>(host_call(SYS_getpid)) ? own().number
                                                                           : program_process(info.si_pid);
}

void on_signal(int number, siginfo_t* info, void* context) {
    translate(number, *info);
    handlers[number](number, info, context);
}

bool is_ours(const struct sigaction& action) {
    return (action.sa_flags & SA_SIGINFO) != 0 && action.sa_sigaction == on_signal;
}
}  // namespace

void expect_origin(int number) {
    due[number] = 1;
}

void forget_origin(int number) {
    due[number] = 0;
}

bool take_origin(int number) {
    const bool expected = due[number] != 0;
    due[number] = 0;
    return expected;
}

void show_origin(int number, siginfo_t& info) {
    const wire::SignalOrigin origin = own().origins[number];
    info.si_code = SI_USER;
    info.si_pid = origin.process;
    info.si_uid = getuid();
    if (number != SIGCHLD || origin.ended == 0) return;
    const int status = origin.status;
    info.si_code = WIFEXITED(status) ? CLD_EXITED : WCOREDUMP(status) ? CLD_DUMPED : CLD_KILLED;
    info.si_status = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
}

void show_origin(signalfd_siginfo& record) {
    if (record.ssi_signo == 0 || record.ssi_signo >= NSIG) return;
    const auto number = static_cast<int>(record.ssi_signo);
    siginfo_t info{};
    info.si_code = record.ssi_code;
    info.si_pid = static_cast<pid_t>(record.ssi_pid);
    info.si_uid = record.ssi_uid;
    translate(number, info);
    if (number == SIGCHLD && info.si_code != record.ssi_code) record.ssi_status = info.si_status;
    record.ssi_code = info.si_code;
    record.ssi_pid = static_cast<std::uint32_t>(info.si_pid);
    record.ssi_uid = info.si_uid;
}

int set_informed_action(int number, const struct sigaction* next, struct sigaction* before) {
    const bool known = number > 0 && number < NSIG;
    const Handler earlier = known ? handlers[number] : nullptr;
    struct sigaction wanted {
    }, old{};
    if (next != nullptr) wanted = *next;
    if (next != nullptr && known && (wanted.sa_flags & SA_SIGINFO) != 0 && wanted.sa_handler != SIG_DFL &&
        wanted.sa_handler != SIG_IGN) {
        handlers[number] = wanted.sa_sigaction;
        wanted.sa_sigaction = on_signal;
    }
    if (REAL(sigaction)(number, next != nullptr ? &wanted : nullptr, &old) != 0) {
        if (known) handlers[number] = earlier;
        return -1;
    }
    if (is_ours(old)) old.sa_sigaction = earlier;
    if (before != nullptr) *before = old;
    return 0;
}

}  // namespace puckloop::shim
