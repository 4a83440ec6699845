#include "cosim/remote/processes/child_process.h"

#include "base/error.h"
#include "cosim/remote/protocol.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

namespace puckloop::cosim {

namespace {

constexpr int kExecFailed = 127;
constexpr std::size_t kMostDescriptors = 4;
constexpr std::chrono::milliseconds kReapPoll{5};  // where the kernel has no descriptors of processes

/// In the child, between fork and exec: nothing here may allocate or lock.
[[noreturn]] void become(const char* program, char* const* arguments, std::span<const int> descriptors,
                         const ChildStreams& streams, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kExecFailed);
    setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    const int nothing =
        open("/dev/null", O_RDONLY);  // no terminal to read from: the group is a background one
    dup2(streams.in < 0 ? nothing : streams.in, STDIN_FILENO);
    if (streams.out >= 0) dup2(streams.out, STDOUT_FILENO);
    if (streams.error >= 0) dup2(streams.error, STDERR_FILENO);
    // First out of each other's way, then to where they belong.
    const int end = protocol::kDescriptor + static_cast<int>(descriptors.size());
    int moved[kMostDescriptors];
    for (std::size_t i = 0; i < descriptors.size(); ++i)
        moved[i] = fcntl(descriptors[i], F_DUPFD, end);
    for (std::size_t i = 0; i < descriptors.size(); ++i)
        dup2(moved[i], protocol::kDescriptor + static_cast<int>(i));
    close_range(static_cast<unsigned>(end), ~0u, 0);  // no files of the parent
    execv(program, arguments);
    _exit(kExecFailed);
}

/// Until the process has ended, `patience` is over or a signal came.
void await_end(pid_t id, std::chrono::milliseconds patience) {
    const int process = static_cast<int>(syscall(SYS_pidfd_open, id, 0));
    if (process < 0) {
        std::this_thread::sleep_for(std::min(patience, kReapPoll));
        return;
    }
    pollfd wait{process, POLLIN, 0};
    poll(&wait, 1, static_cast<int>(patience.count()));
    close(process);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::string& title,
                           std::span<const int> descriptors, const ChildStreams& streams) {
    if (descriptors.size() > kMostDescriptors) throw RunError("too many descriptors for a process");
    std::vector<std::string> words = command;
    words.front() = title;
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t parent = getpid();
    id_ = fork();
    if (id_ < 0) throw RunError(fmt::format("cannot start a process: {}", std::strerror(errno)));
    if (id_ == 0) become(command.front().c_str(), arguments.data(), descriptors, streams, parent);
    setpgid(id_, id_);  // whoever of the two comes first
}

ChildProcess::~ChildProcess() {
    if (!status_) reap();
}

void ChildProcess::reap() {
    // The group first: as long as the child is not reaped, its number belongs to nobody else.
    kill(-id_, SIGKILL);
    kill(id_, SIGKILL);
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    status_ = status;
}

bool ChildProcess::ended(std::chrono::milliseconds patience) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!status_) {
        siginfo_t info{};
        const int failed = waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT);
        const auto left = deadline - std::chrono::steady_clock::now();
        if (failed == 0 && info.si_pid == id_)
            reap();
        else if (left <= left.zero())
            return false;
        else
            await_end(id_, std::chrono::ceil<std::chrono::milliseconds>(left));
    }
    return true;
}

std::string ChildProcess::ending() const {
    if (!status_) return "still runs";
    if (WIFSIGNALED(*status_))
        return fmt::format("was killed by signal {} ({})", WTERMSIG(*status_), strsignal(WTERMSIG(*status_)));
    return fmt::format("exited with status {}", WEXITSTATUS(*status_));
}

}  // namespace puckloop::cosim
