#include "campaigns/jobs/isolated.h"

#include "base/error.h"
#include "base/plain_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace puckloop::jobs {

namespace {

constexpr int kFailed = 3;   ///< status of a child that leaves a message
constexpr int kRefused = 2;  ///< the same, of what the user gave
constexpr int kBroke = 4;    ///< the same, of an exception that nothing outside explains

/// Signals that come from outside: of the user, of a machine without memory, of a limit.
bool is_from_outside(int signal) {
    constexpr std::array kSignals{SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ};
    return std::find(kSignals.begin(), kSignals.end(), signal) != kSignals.end();
}

/// In the child: never returns.
[[noreturn]] void work_here(const std::function<void()>& work, int message) {
    std::string problem;
    int status = kFailed;
    try {
        work();
        ::_exit(0);
    } catch (const InputError& error) {
        problem = error.what();
        status = kRefused;
    } catch (const RunError& error) {
        problem = error.what();
    } catch (const std::bad_alloc& error) {
        problem = reason_of(error);
    } catch (const std::exception& error) {
        problem = reason_of(error);
        status = kBroke;
    }
    [[maybe_unused]] const auto written = ::write(message, problem.data(), problem.size());
    ::_exit(status);
}

std::string read_all(int descriptor) {
    std::string text;
    std::array<char, 4096> part{};
    for (;;) {
        const auto count = ::read(descriptor, part.data(), part.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return text;
        text.append(part.data(), static_cast<std::size_t>(count));
    }
}

}  // namespace

void run_isolated(const std::function<void()>& work) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw RunError(fmt::format("no pipe: {}", std::strerror(errno)));
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(ends[0]);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent) ::_exit(kFailed);
        const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
        for (int descriptor = 0; descriptor <= STDERR_FILENO; ++descriptor)
            ::dup2(nothing, descriptor);
        work_here(work, ends[1]);
    }
    ::close(ends[1]);
    if (child < 0) {
        ::close(ends[0]);
        throw RunError(fmt::format("no process for a run: {}", std::strerror(errno)));
    }
    const std::string problem = read_all(ends[0]);
    ::close(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
        const std::string how =
            fmt::format("puckloop itself was ended by SIG{}", sigabbrev_np(WTERMSIG(status)));
        if (is_from_outside(WTERMSIG(status))) throw Killed(how);
        throw Broke(how);
    }
    if (WEXITSTATUS(status) == kBroke) throw Broke("puckloop itself threw: " + problem);
    if (WEXITSTATUS(status) == kRefused) throw InputError("", "", problem);
    if (WEXITSTATUS(status) != 0)
        throw RunError(problem.empty() ? fmt::format("a run ended with status {}", WEXITSTATUS(status))
                                       : problem);
}

}  // namespace puckloop::jobs
