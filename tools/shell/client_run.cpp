#include "tools/shell/client_run.h"

#include "base/error.h"
#include "view/live/control_client.h"

#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

constexpr int kShellSignal = 128;

/// By what one control.json differs from another.
std::optional<std::pair<ino_t, timespec>> version_of(const fs::path& file) {
    struct stat info {};
    if (::stat(file.c_str(), &info) != 0) return std::nullopt;
    return std::pair(info.st_ino, info.st_mtim);
}

bool same(const std::optional<std::pair<ino_t, timespec>>& a,
          const std::optional<std::pair<ino_t, timespec>>& b) {
    return a && b && a->first == b->first && a->second.tv_sec == b->second.tv_sec &&
           a->second.tv_nsec == b->second.tv_nsec;
}

int status_of(int waited) {
    return WIFEXITED(waited) ? WEXITSTATUS(waited) : kShellSignal + WTERMSIG(waited);
}

int wait_for(pid_t child) {
    int waited = 0;
    while (::waitpid(child, &waited, 0) < 0 && errno == EINTR) {
    }
    return status_of(waited);
}

}  // namespace

int run_with_client(const RunWithClient& parts) {
    const fs::path folder = parts.results();
    const auto before = version_of(folder / "control.json");
    std::fflush(nullptr);
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) throw RunError(std::string("cannot start the run's process: ") + std::strerror(errno));
    if (child == 0) {
        // A Ctrl-C is for the client, which then ends the run; a client that is killed takes it along.
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (::getppid() != parent) ::raise(SIGTERM);
        return parts.run();
    }
    constexpr auto kLook = std::chrono::milliseconds(5);
    while (same(before, version_of(folder / "control.json")) || !view::ControlClient::is_there(folder)) {
        int waited = 0;
        if (::waitpid(child, &waited, WNOHANG) == child) return status_of(waited);  // it has said why
        std::this_thread::sleep_for(kLook);
    }
    return with_child_run(child, [&] { return parts.client(folder, child); });
}

int with_child_run(pid_t run, const std::function<int()>& client) {
    int status = 0;
    try {
        status = client();
    } catch (...) {
        ::kill(run, SIGTERM);
        wait_for(run);
        throw;
    }
    const int ended = wait_for(run);
    return status != 0 ? status : ended;
}

}  // namespace puckloop::tools
