#include "linuxboard/shim/preload/processes/make_process.h"

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

extern "C" pid_t _Fork(void) noexcept;

namespace puckloop::shim {

namespace {
bool making = false;

/// While it lives the end of the process in between sends no signal to the program.
class QuietChildren {
  public:
    QuietChildren() {
        struct sigaction quiet {};
        quiet.sa_handler = SIG_DFL;
        sigaction(SIGCHLD, &quiet, &before_);
    }
    ~QuietChildren() {
        struct sigaction quiet {};
        quiet.sa_handler = SIG_DFL;
        sigaction(SIGCHLD, &quiet, nullptr);  // forgets one that is blocked
        sigaction(SIGCHLD, &before_, nullptr);
    }
    QuietChildren(const QuietChildren&) = delete;
    QuietChildren& operator=(const QuietChildren&) = delete;
    /// In the process made: what the program had set.
    void restore() const { sigaction(SIGCHLD, &before_, nullptr); }

  private:
    struct sigaction before_ {};
};
}  // namespace

bool is_making_process() {
    return making;
}

bool ask_for_process(Birth& birth, const std::string& left) {
    charge(page().charges.thread);
    wire::Request request;
    request.op = wire::Op::Fork;
    const std::int64_t slot = device_call(request, left.data(), left.size());
    if (slot < 0) {
        errno = EAGAIN;
        return false;
    }
    birth.slot = static_cast<std::uint32_t>(slot);
    birth.link = take_passed();
    return true;
}

int in_between(int (*work)(void*), void* context, bool with_handlers) {
    const QuietChildren quiet;
    making = true;
    const pid_t between = with_handlers ? REAL(fork)() : REAL(_Fork)();
    if (between == 0) {
        quiet.restore();
        const int status = work(context);
        if (status < 0) {  // the new process itself returns from here
            making = false;
            return status;
        }
        host_call(SYS_exit_group, status);
    }
    making = false;
    if (between < 0) return -1;
    int status = 0;
    long reaped = 0;
    do {
        reaped = host_call(SYS_wait4, between, reinterpret_cast<long>(&status), 0, 0);
    } while (reaped < 0 && errno == EINTR);
    return reaped == between && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

pid_t report_birth(const Birth& birth, bool made) {
    const pid_t number = page().processes[birth.slot].number;
    REAL(close)(birth.link);
    wire::Request request;
    request.op = wire::Op::Forked;
    request.a = birth.slot;
    request.b = made ? 1 : 0;
    device_call(request);
    return made ? number : -1;
}

}  // namespace puckloop::shim
