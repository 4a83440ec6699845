#include "benchmark/measures/timed_run.h"

#include "base/error.h"
#include "base/json.h"
#include "cosim/interrupt.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>

namespace puckloop::tools {

namespace {

constexpr int kCannotStart = 127;

/// An open file without a name, for what a program writes.
class Capture {
  public:
    Capture() : descriptor_(::memfd_create("puckloop bench", MFD_CLOEXEC)) {
        if (descriptor_ < 0) throw RunError(fmt::format("no memory for output: {}", std::strerror(errno)));
    }
    ~Capture() { ::close(descriptor_); }
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;
    int descriptor() const { return descriptor_; }
    std::string text() const {
        std::string text(static_cast<std::size_t>(std::max<off_t>(0, ::lseek(descriptor_, 0, SEEK_END))),
                         '\0');
        const ssize_t got = ::pread(descriptor_, text.data(), text.size(), 0);
        text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
        return text;
    }

  private:
    int descriptor_;
};

std::string last_line(std::string text) {
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

[[noreturn]] void become(const std::vector<char*>& words, const Capture& out, const Capture& error,
                         pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(kCannotStart);
    ::dup2(out.descriptor(), STDOUT_FILENO);
    ::dup2(error.descriptor(), STDERR_FILENO);
    ::execv(words[0], words.data());
    ::dprintf(STDERR_FILENO, "%s: %s\n", words[0], std::strerror(errno));
    ::_exit(kCannotStart);
}

void watch_until_end(pid_t child, const std::function<void(pid_t)>& watch, int period_ms) {
    const int descriptor = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
    if (descriptor < 0) return;
    pollfd end{descriptor, POLLIN, 0};
    while (true) {
        watch(child);
        const int ready = ::poll(&end, 1, period_ms);
        if (ready > 0 || (ready < 0 && errno != EINTR)) break;
    }
    ::close(descriptor);
}

double seconds(const timeval& time) {
    constexpr double kMicro = 1e-6;
    return static_cast<double>(time.tv_sec) + kMicro * static_cast<double>(time.tv_usec);
}

}  // namespace

ProgramTiming time_program(const std::vector<std::string>& words, const std::function<void(pid_t)>& watch,
                           int period_ms) {
    using Clock = std::chrono::steady_clock;
    const Capture out, error;
    std::vector<std::string> copies = words;
    std::vector<char*> pointers;
    for (std::string& word : copies)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    // A Ctrl-C at the terminal reaches the child too, which ends by itself.
    const cosim::InterruptGuard interrupt;
    const pid_t self = ::getpid();
    const auto start = Clock::now();
    const pid_t child = ::fork();
    if (child < 0) throw RunError(fmt::format("{} cannot be started: {}", words[0], std::strerror(errno)));
    if (child == 0) become(pointers, out, error, self);
    if (watch) watch_until_end(child, watch, period_ms);
    int status = 0;
    rusage usage{};
    while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR)
        if (*interrupt.flag() == SIGTERM) ::kill(child, SIGTERM);
    ProgramTiming timing;
    timing.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
    if (*interrupt.flag() != 0) throw RunError("interrupted");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw RunError(fmt::format("{}: {}", words[0], last_line(error.text())));
    timing.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    timing.output = out.text();
    return timing;
}

RunTiming time_run(const std::filesystem::path& program, const RunSpec& spec,
                   const std::filesystem::path& folder, const std::function<void(pid_t)>& watch) {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    std::vector<std::string> words{program.string(),
                                   "run",
                                   spec.scenario.string(),
                                   "--duration",
                                   fmt::format("{}", spec.simulated_s),
                                   "--no-cache",
                                   "--json",
                                   "--out",
                                   folder.string()};
    if (spec.in_process) words.emplace_back("--in-process");
    if (spec.in_process && spec.threads != 0) {
        words.emplace_back("--threads");
        words.push_back(std::to_string(spec.threads));
    }
    words.insert(words.end(), spec.options.begin(), spec.options.end());
    RunTiming timing;
    timing.program = time_program(words, watch);
    std::ifstream file(folder / "report.json");
    const auto report = nlohmann::json::parse(file, nullptr, false);
    if (!report.is_object()) throw RunError(fmt::format("{} wrote no report", program.string()));
    timing.simulated_s = report.at("simulated_s");
    timing.wall_s = report.at("wall_s");
    timing.trace_sha256 = report.at("trace_sha256");
    return timing;
}

}  // namespace puckloop::tools
