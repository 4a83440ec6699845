#include "linuxboard/shim/process.h"

#include "base/error.h"
#include "base/random.h"
#include "linuxboard/shim/program_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <system_error>

extern char** environ;

namespace puckloop::linuxboard {

namespace {
constexpr int kFirstPrivateFd = 500;  // well above what a program counts on
constexpr rlim_t kUsualDescriptors = 1024;
constexpr double kLookInterval = 0.5;  // s of wall clock between looks at a program that keeps silent
constexpr double kLoadedHostFactor = 10.0;
constexpr int kEndAttempts = 2000;
constexpr useconds_t kEndPause = 1000;  // together 2 s
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr double kMillisecondsPerSecond = 1000.0;

[[noreturn]] void fail(const std::string& what) {
    throw RunError(what + ": " + std::strerror(errno));
}

std::string shim_file(const LinuxSpec& spec) {
    std::string file = spec.shim;
    if (file.empty()) {
        const char* set = std::getenv("PUCKLOOP_SHIM");
        file = set != nullptr ? set : PUCKLOOP_SHIM_FILE;
    }
    if (access(file.c_str(), R_OK) != 0)
        throw InputError(file, "", "the library to preload is not there", "build the target puckloop_shim");
    return file;
}

struct HostState {
    char code = '?';          ///< as in proc(5): R running, S sleeping, Z ended
    double computed_s = 0.0;  ///< processor time used by all threads
};

HostState host_state(pid_t pid) {
    // The main thread may sleep while another one computes: any thread that runs makes the process run.
    HostState state;
    std::error_code none;
    for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", pid), none)) {
        std::ifstream file(task.path() / "stat");
        std::string text;
        std::getline(file, text);
        const std::size_t name_end = text.rfind(')');
        if (name_end == std::string::npos || name_end + 2 >= text.size()) continue;
        std::istringstream fields(text.substr(name_end + 2));
        char code = '?';
        fields >> code;
        constexpr int kFieldsBeforeTimes = 10;  // from ppid to cmajflt
        std::string skipped;
        for (int i = 0; i < kFieldsBeforeTimes; ++i)
            fields >> skipped;
        double user = 0, system = 0;
        fields >> user >> system;
        state.computed_s += (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
        if (state.code != 'R') state.code = code;
    }
    return state;
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
    std::vector<char*> list;
    for (std::string& text : strings)
        list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}
}  // namespace

Process::Process(const LinuxSpec& spec)
    : spec_(spec),
      file_(find_program(spec.program)),
      shim_(shim_file(spec)),
      buffer_(sizeof(wire::Request) + wire::kMaximumData) {
    if (!spec.log.empty()) {
        log_fd_ = open(spec.log.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
        if (log_fd_ < 0)
            throw InputError(spec.log, "", std::strerror(errno), "a log file that can be written");
    }
    prepare_page();
}

Process::~Process() {
    kill();
    if (page_ != nullptr) munmap(page_, sizeof *page_);
    if (page_fd_ >= 0) close(page_fd_);
    if (log_fd_ >= 0) close(log_fd_);
}

void Process::prepare_page() {
    page_fd_ = memfd_create("puckloop-shim", MFD_CLOEXEC);
    if (page_fd_ < 0 || ftruncate(page_fd_, sizeof(wire::Page)) != 0) fail("shared memory");
    void* memory = mmap(nullptr, sizeof(wire::Page), PROT_READ | PROT_WRITE, MAP_SHARED, page_fd_, 0);
    if (memory == MAP_FAILED) fail("shared memory");
    page_ = new (memory) wire::Page;
    page_->real_time = spec_.real_time ? 1 : 0;
    page_->epoch = spec_.epoch_s * kNanosecondsPerSecond;
    page_->uptime = cosim::from_seconds(spec_.uptime_s) / cosim::kNanosecond;
    page_->seed = RandomStream(spec_.seed, "linux." + spec_.name).next();
    page_->charges = spec_.charges;
    page_->oversleep = spec_.oversleep;
    std::strncpy(page_->host_name, spec_.host_name.c_str(), sizeof page_->host_name - 1);
    std::size_t index = 0;
    const auto add = [&](wire::DeviceKind kind, const std::string& path) {
        wire::DeviceName& device = page_->devices[index++];
        device.kind = kind;
        if (path.size() >= sizeof device.path) throw InputError("", path, "the device's name is too long");
        std::strncpy(device.path, path.c_str(), sizeof device.path - 1);
    };
    if (!spec_.tty.empty()) add(wire::DeviceKind::Tty, spec_.tty);
    for (const std::string& path : spec_.i2c)
        add(wire::DeviceKind::I2c, path);
}

void Process::start() {
    int sockets[2] = {-1, -1};
    int report[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) != 0) fail("socket pair");
    if (pipe2(report, O_CLOEXEC) != 0) fail("pipe");

    // Everything is prepared before fork(): the child may only make system calls.
    std::vector<std::string> args{spec_.program};
    args.insert(args.end(), spec_.args.begin(), spec_.args.end());
    std::vector<std::string> env;
    std::string preload = shim_;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view text = *entry;
        if (text.starts_with("LD_PRELOAD=")) {
            preload += ":" + std::string(text.substr(text.find('=') + 1));
        } else if (!text.starts_with(wire::kLinkVariable)) {
            env.emplace_back(text);
        }
    }
    for (const auto& [key, value] : spec_.env) {
        std::erase_if(env, [&](const std::string& text) { return text.starts_with(key + "="); });
        env.push_back(key + "=" + value);
    }
    env.push_back("LD_PRELOAD=" + preload);
    constexpr int kPidDigits = 10;
    env.push_back(fmt::format("{}={},{},{}", wire::kLinkVariable, kFirstPrivateFd, kFirstPrivateFd + 1,
                              std::string(kPidDigits, '0')));
    char* pid_text = env.back().data() + env.back().size() - kPidDigits;
    const std::vector<char*> arguments = pointers(args);
    const std::vector<char*> variables = pointers(env);
    const char* stdin_file = spec_.stdin_file.empty() ? "/dev/null" : spec_.stdin_file.c_str();

    pid_ = fork();
    if (pid_ < 0) fail("fork");
    if (pid_ == 0) {
        const auto give_up = [&](int where) {
            const int status[2] = {where, errno};
            [[maybe_unused]] const auto written = write(report[1], status, sizeof status);
            _exit(127);
        };
        setpgid(0, 0);  // Ctrl-C ends the run; the run ends the program
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        personality(ADDR_NO_RANDOMIZE);
        pid_t own = getpid();
        for (int digit = kPidDigits - 1; digit >= 0; --digit, own /= 10)
            pid_text[digit] = static_cast<char>('0' + own % 10);
        const int in = open(stdin_file, O_RDONLY);
        if (in < 0) give_up(1);
        if (in != STDIN_FILENO) {
            dup2(in, STDIN_FILENO);
            close(in);
        }
        const int out = log_fd_ >= 0 ? log_fd_ : open("/dev/null", O_WRONLY);
        dup2(out, STDOUT_FILENO);
        dup2(out, STDERR_FILENO);
        rlimit limit{};  // puckloop may have raised its own
        if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
            limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, kUsualDescriptors);
            setrlimit(RLIMIT_NOFILE, &limit);
        }
        // Either may be where the other one goes, in a process with many descriptors.
        const int page = fcntl(page_fd_, F_DUPFD, kFirstPrivateFd + 2);
        const int link = fcntl(sockets[1], F_DUPFD, kFirstPrivateFd + 2);
        if (page < 0 || link < 0 || dup2(link, kFirstPrivateFd) < 0 || dup2(page, kFirstPrivateFd + 1) < 0)
            give_up(2);
        close(page);
        close(link);
        if (!spec_.cwd.empty() && chdir(spec_.cwd.c_str()) != 0) give_up(3);
        execve(file_.c_str(), arguments.data(), variables.data());
        give_up(0);
    }
    close(sockets[1]);
    close(report[1]);
    socket_ = sockets[0];
    int status[2] = {0, 0};
    const bool failed = read(report[0], status, sizeof status) == sizeof status;
    close(report[0]);
    if (failed) {
        reap(true);
        if (status[0] == 2)
            throw RunError(
                fmt::format("{}: no descriptors for the program: {}", file_, std::strerror(status[1])));
        const std::string file = status[0] == 1 ? stdin_file : status[0] == 3 ? spec_.cwd : file_;
        throw InputError(file, "", std::strerror(status[1]), "a program that can be started");
    }
    exit_status_.reset();
    lost_ = false;
}

void Process::reply(const wire::Reply& reply, const std::vector<FinishedCall>& calls) {
    out_.assign(reinterpret_cast<const char*>(&reply), sizeof reply);
    for (const FinishedCall& call : calls) {
        out_.append(reinterpret_cast<const char*>(&call.header), sizeof call.header);
        out_ += call.data;
    }
    // A program that has just died is noticed when it is listened to.
    [[maybe_unused]] const auto sent = send(socket_, out_.data(), out_.size(), MSG_NOSIGNAL);
}

Heard Process::hear(double watchdog, wire::Request& request, std::string& data) {
    pollfd entry{socket_, POLLIN, 0};
    ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    const double slice = std::min(watchdog, kLookInterval);
    double waited = 0.0;
    double computed_before = -1.0;
    while (count < 0 && (errno == EAGAIN || errno == EINTR)) {
        const int ready = poll(&entry, 1, static_cast<int>(slice * kMillisecondsPerSecond));
        count = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
        if (ready != 0 || count >= 0) continue;
        // On a loaded host a program that computes may just not get the processor: its own time counts.
        const HostState state = host_state(pid_);
        if (computed_before < 0) computed_before = state.computed_s;
        if (state.code == 'Z' || state.code == 'X') break;
        waited += slice;
        const bool computed_long = state.computed_s - computed_before + slice >= watchdog;
        const bool slept_long = state.code != 'R' && waited >= watchdog;
        if (computed_long || slept_long || waited >= watchdog * kLoadedHostFactor) return Heard::Silent;
        errno = EAGAIN;
    }
    if (count < static_cast<ssize_t>(sizeof request)) {
        await_end();
        return Heard::Ended;
    }
    std::memcpy(&request, buffer_.data(), sizeof request);
    data.assign(buffer_.data() + sizeof request, static_cast<std::size_t>(count) - sizeof request);
    return Heard::Request;
}

void Process::await_end() {
    // The link closes a moment before the process is gone. One that lives on without it cannot be conducted.
    for (int attempt = 0; attempt < kEndAttempts && pid_ > 0; ++attempt) {
        reap(false);
        if (pid_ > 0) usleep(kEndPause);
    }
    lost_ = pid_ > 0;
    kill();
}

void Process::reap(bool wait) {
    if (pid_ <= 0) return;
    if (waitpid(pid_, &wait_status_, wait ? 0 : WNOHANG) != pid_) return;
    pid_ = -1;
    exit_status_ = WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : 128 + WTERMSIG(wait_status_);
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
}

void Process::kill() {
    if (pid_ <= 0) return;
    ::kill(-pid_, SIGKILL);
    ::kill(pid_, SIGKILL);
    reap(true);
}

void Process::echo_output() {
    if (!spec_.echo_output || log_fd_ < 0) return;
    char text[4096];
    for (ssize_t count; (count = pread(log_fd_, text, sizeof text, echoed_)) > 0; echoed_ += count) {
        [[maybe_unused]] const auto written = write(STDOUT_FILENO, text, static_cast<std::size_t>(count));
    }
}

std::string Process::describe_end() const {
    if (lost_) return "went out of simulated time (it closed the library's files or became another program)";
    if (WIFSIGNALED(wait_status_)) {
        const int signal = WTERMSIG(wait_status_);
        return fmt::format("was killed by SIG{} ({})", sigabbrev_np(signal), sigdescr_np(signal));
    }
    return fmt::format("exited with status {}", WEXITSTATUS(wait_status_));
}

bool Process::crashed() const {
    if (!WIFSIGNALED(wait_status_)) return false;
    switch (WTERMSIG(wait_status_)) {
    case SIGSEGV:
    case SIGABRT:
    case SIGBUS:
    case SIGFPE:
    case SIGILL:
    case SIGSYS:
    case SIGTRAP:
        return true;
    default:
        return false;
    }
}

bool Process::dies_of(int signal) const {
    std::error_code none;
    for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", pid_), none)) {
        std::ifstream file(task.path() / "status");
        for (std::string line; std::getline(file, line);) {
            if (!line.starts_with("SigCgt:") && !line.starts_with("SigIgn:") && !line.starts_with("SigBlk:"))
                continue;
            const auto mask = std::strtoull(line.c_str() + sizeof "SigCgt:" - 1, nullptr, 16);
            if ((mask >> (signal - 1) & 1) != 0) return false;
        }
    }
    return true;
}

std::string Process::describe_silence() const {
    const char state = host_state(pid_).code;
    const char* call = page_->call_name[0] != '\0' ? page_->call_name : "its start";
    return fmt::format("{}; last call taken over: {} by thread {}",
                       state == 'R' ? "it computes without any call that lets time pass"
                                    : "it waits in a call that is outside of simulated time",
                       call, page_->thread.load());
}

std::string Process::last_line() const {
    if (spec_.log.empty()) return {};
    std::ifstream log(spec_.log);
    constexpr std::streamoff kTail = 400;
    log.seekg(0, std::ios::end);
    const auto size = static_cast<std::streamoff>(log.tellg());
    log.seekg(std::max<std::streamoff>(0, size - kTail));
    std::string last;
    for (std::string line; std::getline(log, line);) {
        if (!line.empty()) last = line;
    }
    return last;
}

}  // namespace puckloop::linuxboard
