#include "linuxboard/shim/node/launcher.h"

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/random.h"
#include "cosim/core/cores.h"
#include "linuxboard/shim/kernel/linux_faults.h"
#include "linuxboard/shim/node/last_line.h"
#include "linuxboard/shim/node/program_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <linux/close_range.h>
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
#include <fstream>
#include <iterator>
#include <new>

extern char** environ;

namespace puckloop::linuxboard {

namespace {
constexpr int kFirstPrivateFd = 500;  // well above what a program counts on
constexpr rlim_t kUsualDescriptors = 1024;
constexpr rlim_t kFewestDescriptors = 32;  // of a program; with fewer it is not started
constexpr rlim_t kPrivateDescriptors = 5;  // link and page; on their way there a copy of each, and the report

[[noreturn]] void fail(const std::string& what) {
    const int error = errno;
    throw RunError(
        fmt::format("{}: {}{}", what, std::strerror(error),
                    error == EMFILE ? " (a program takes 3 here; ulimit -n 4096 raises the limit)" : ""));
}

void resize_shared(int fd, std::uint64_t size) {
    if (ftruncate(fd, static_cast<off_t>(size)) == 0) return;
    if (errno == EFBIG)
        throw RunError(
            fmt::format("shared memory of a program: {} bytes are more than the limit of file sizes "
                        "allows (ulimit -f)",
                        size));
    fail("shared memory");
}

std::string shim_file(const LinuxSpec& spec) {
    std::string file = spec.shim;
    if (file.empty()) {
        constexpr const char* kName = "libpuckloop_shim.so";
        const char* set = std::getenv("PUCKLOOP_SHIM");
        file = set != nullptr ? set : shipped_program(kName, "linuxboard/shim").string();
        if (file.empty()) file = kName;
    }
    if (access(file.c_str(), R_OK) != 0)
        throw InputError(file, "", "the library to preload is not there",
                         "the one that is built and installed with this program, or PUCKLOOP_SHIM");
    return file;
}

/// Most files that the program may have open.
rlim_t descriptor_limit() {
    rlimit limit{};
    return getrlimit(RLIMIT_NOFILE, &limit) == 0 ? std::min(limit.rlim_max, kUsualDescriptors)
                                                 : kUsualDescriptors;
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
    std::vector<char*> list;
    for (std::string& text : strings)
        list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

/// All that the child needs; it may not allocate.
struct Child {
    const char* file;
    char* const* arguments;
    char* const* variables;
    const char* stdin_file;
    const char* folder;  // to start in; nullptr: this one
    int log, page, link, report;
    int first;             // descriptor of the link, the page follows
    rlim_t most;           // descriptors
    const sigset_t& mask;  // of signals
    wire::ProcessEntry& entry;
};

/// The child of vfork() has this process's memory until it has become the program: no handler of puckloop's
/// may run there.
void drop_handlers() {
    for (int signal = 1; signal < NSIG; ++signal) {
        struct sigaction action {};
        if (sigaction(signal, nullptr, &action) != 0) continue;
        if (action.sa_handler == SIG_DFL || action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = SIG_DFL;
        sigaction(signal, &action, nullptr);
    }
}

/// In the child: system calls only.
[[noreturn]] void become(const Child& child) {
    // Away from where the link and the page go.
    const int report = fcntl(child.report, F_DUPFD_CLOEXEC, child.first + 2);
    const auto give_up = [&](int where) {
        const int status[2] = {where, errno};
        [[maybe_unused]] const auto written = write(report, status, sizeof status);
        _exit(127);
    };
    drop_handlers();
    sigprocmask(SIG_SETMASK, &child.mask, nullptr);
    setpgid(0, 0);  // Ctrl-C ends the run; the run ends the program
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    personality(ADDR_NO_RANDOMIZE);
    cosim::use_all_cores_in_child();
    child.entry.host = getpid();
    const int in = open(child.stdin_file, O_RDONLY);
    if (in < 0) give_up(1);
    if (in != STDIN_FILENO) {
        dup2(in, STDIN_FILENO);
        close(in);
    }
    const int out = child.log >= 0 ? child.log : open("/dev/null", O_WRONLY);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    // Neither puckloop's files nor their numbers are the program's business: it differs with the placement.
    close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    // Either may be where the other one goes, in a process with many descriptors.
    const int page = fcntl(child.page, F_DUPFD, child.first + 2);
    const int link = fcntl(child.link, F_DUPFD, child.first + 2);
    if (page < 0 || link < 0 || dup2(link, child.first) < 0 || dup2(page, child.first + 1) < 0) give_up(2);
    close(page);
    close(link);
    rlimit limit{};  // puckloop may have raised its own
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = child.most;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
    if (child.folder != nullptr && chdir(child.folder) != 0) give_up(3);
    execve(child.file, child.arguments, child.variables);
    give_up(0);
    __builtin_unreachable();
}

/// vfork(), which comes back when the child has become the program or has given up: fork() would copy the
/// page tables of all boards, and fault in again every page that they write.
[[gnu::noinline]] pid_t start_child(const Child& child) {
    const pid_t id = vfork();
    if (id == 0) become(child);
    return id;
}
}  // namespace

Launcher::Launcher(const LinuxSpec& spec)
    : spec_(spec), file_(find_program(spec.program)), shim_(shim_file(spec)), log_(spec.log) {
    prepare_page();
}

Launcher::~Launcher() {
    if (page_ != nullptr) munmap(page_, wire::kSharedSize);
    if (video_ != nullptr) munmap(video_, spec_.cameras.size() * wire::kVideoSize);
    if (page_fd_ >= 0) close(page_fd_);
}

void Launcher::prepare_page() {
    page_fd_ = memfd_create("puckloop-shim", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    const std::uint64_t size = spec_.cameras.empty()
                                   ? wire::kSharedSize
                                   : wire::video_offset(static_cast<std::uint32_t>(spec_.cameras.size()));
    if (page_fd_ < 0) fail("shared memory");
    resize_shared(page_fd_, size);
    // The program has the memory too: it may not take away what is mapped here.
    if (fcntl(page_fd_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
        fail("sealing the shared memory");
    void* memory = mmap(nullptr, wire::kSharedSize, PROT_READ | PROT_WRITE, MAP_SHARED, page_fd_, 0);
    if (memory == MAP_FAILED) fail("shared memory");
    page_ = new (memory) wire::Page;
    page_->real_time = spec_.real_time ? 1 : 0;
    page_->ask_always = spec_.ask_always ? 1 : 0;
    page_->epoch = spec_.epoch_s * (cosim::kSecond / cosim::kNanosecond);
    page_->uptime = cosim::from_seconds(spec_.uptime_s) / cosim::kNanosecond;
    page_->clock_error = clock_error_of(spec_);
    page_->seed = RandomStream(spec_.seed, "linux." + spec_.name).next();
    page_->charges = spec_.charges;
    page_->oversleep = spec_.oversleep;
    std::strncpy(page_->host_name, spec_.host_name.c_str(), sizeof page_->host_name - 1);
    std::size_t index = 0;
    const auto add = [&](wire::DeviceKind kind, const std::string& path) {
        wire::DeviceName& device = page_->devices[index];
        device.kind = kind;
        device.device = static_cast<std::uint32_t>(index++);
        if (path.size() >= sizeof device.path) throw InputError("", path, "the device's name is too long");
        std::strncpy(device.path, path.c_str(), sizeof device.path - 1);
    };
    if (!spec_.tty.empty()) add(wire::DeviceKind::Tty, spec_.tty);
    for (const std::string& path : spec_.i2c)
        add(wire::DeviceKind::I2c, path);
    for (const CameraSpec& camera : spec_.cameras)
        add(wire::DeviceKind::Video, camera.device);
    for (const std::string& path : spec_.tty_aliases) {
        add(wire::DeviceKind::Tty, path);
        page_->devices[index - 1].device = 0;
    }
    if (!spec_.cameras.empty()) map_video();
    if (!spec_.network) return;
    page_->networked = 1;
    page_->asks_for_names = LinuxFaults::concern_names(spec_.faults) ? 1 : 0;
    page_->network_prefix = static_cast<std::uint8_t>(spec_.network->prefix);
    page_->network_address = place_of(*spec_.network).address;
    for (const NetworkName& one : spec_.network->names) {
        wire::HostEntry& host = page_->hosts[page_->host_count++];
        host.address = protocols::address_of(one.address).value_or(0);
        std::strncpy(host.name, one.name.c_str(), sizeof host.name - 1);
    }
}

void Launcher::map_video() {
    const std::uint64_t size = spec_.cameras.size() * wire::kVideoSize;
    constexpr std::uint64_t kFirst = wire::video_offset(0);
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, page_fd_, kFirst);
    if (memory == MAP_FAILED) fail("shared memory of the cameras");
    video_ = static_cast<char*>(memory);
}

char* Launcher::video_memory(std::size_t camera) {
    return video_ + camera * wire::kVideoSize;
}

std::unique_ptr<Process> Launcher::start() {
    for (wire::ProcessEntry& other : page_->processes)
        other.state = wire::ProcessEntry::Free;
    wire::ProcessEntry& entry = page_->processes[0];
    entry.state = wire::ProcessEntry::Alive;
    entry.number = entry.group = wire::kFirstProcess;
    entry.parent = wire::kNoParent;
    entry.computed = entry.children_computed = 0;
    entry.faults = 0;
    page_->alive = 1;
    wire::Channel& channel = *new (wire::channel_of(*page_, 0)) wire::Channel;
    const rlim_t most = descriptor_limit();
    if (most < kFewestDescriptors)
        throw RunError(fmt::format("{}: the limit of open files is {} (ulimit -n), a program needs {}", file_,
                                   most, kFewestDescriptors));
    const int first = static_cast<int>(std::min<rlim_t>(kFirstPrivateFd, most - kPrivateDescriptors));
    int sockets[2] = {-1, -1};
    int report[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) != 0) fail("socket pair");
    if (pipe2(report, O_CLOEXEC) != 0) fail("pipe");

    // Everything is prepared before start_child(): the child may only make system calls.
    std::vector<std::string> args{spec_.program};
    args.insert(args.end(), spec_.args.begin(), spec_.args.end());
    std::vector<std::string> env;
    std::string preload = shim_;
    for (char** variable = environ; *variable != nullptr; ++variable) {
        const std::string_view text = *variable;
        if (text.starts_with("LD_PRELOAD=")) {
            preload += ":" + std::string(text.substr(text.find('=') + 1));
        } else if (!text.starts_with(wire::kLinkVariable)) {
            env.emplace_back(text);
        }
    }
    // What Python keeps for its next start would make that one another: its calls take time.
    constexpr std::string_view kNoByteCode = "PYTHONDONTWRITEBYTECODE=";
    if (std::none_of(env.begin(), env.end(),
                     [](const std::string& text) { return text.starts_with(kNoByteCode); }))
        env.push_back(std::string(kNoByteCode) + "1");
    for (const auto& [key, value] : spec_.env) {
        std::erase_if(env, [&](const std::string& text) { return text.starts_with(key + "="); });
        env.push_back(key + "=" + value);
    }
    env.push_back("LD_PRELOAD=" + preload);
    env.push_back(fmt::format("{}={},{},0", wire::kLinkVariable, first, first + 1));
    const std::vector<char*> arguments = pointers(args);
    const std::vector<char*> variables = pointers(env);
    const char* stdin_file = spec_.stdin_file.empty() ? "/dev/null" : spec_.stdin_file.c_str();

    sigset_t all, mask;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &mask);
    const pid_t pid = start_child({file_.c_str(), arguments.data(), variables.data(), stdin_file,
                                   spec_.cwd.empty() ? nullptr : spec_.cwd.c_str(), log_.descriptor(),
                                   page_fd_, sockets[1], report[1], first, most, mask, entry});
    const int error = errno;
    pthread_sigmask(SIG_SETMASK, &mask, nullptr);
    errno = error;
    if (pid < 0) fail("vfork");
    close(sockets[1]);
    close(report[1]);
    entry.host = pid;
    auto process = std::make_unique<Process>(sockets[0], entry, channel);
    int status[2] = {0, 0};
    const bool failed = read(report[0], status, sizeof status) == sizeof status;
    close(report[0]);
    if (failed) {
        if (status[0] == 2)
            throw RunError(fmt::format("{}: no descriptors for the program (ulimit -n): {}", file_,
                                       std::strerror(status[1])));
        const std::string file = status[0] == 1 ? stdin_file : status[0] == 3 ? spec_.cwd : file_;
        throw InputError(file, "", std::strerror(status[1]), "a program that can be started");
    }
    return process;
}

void Launcher::echo_output() {
    if (!spec_.echo_output || log_.descriptor() < 0) return;
    char text[4096];
    for (ssize_t count; (count = pread(log_.descriptor(), text, sizeof text, echoed_)) > 0;
         echoed_ += count) {
        [[maybe_unused]] const auto written = write(STDOUT_FILENO, text, static_cast<std::size_t>(count));
    }
}

std::string Launcher::last_line() const {
    if (spec_.log.empty()) return {};
    std::ifstream log(spec_.log);
    constexpr std::streamoff kTail = 4096;
    log.seekg(0, std::ios::end);
    const auto size = static_cast<std::streamoff>(log.tellg());
    log.seekg(std::max<std::streamoff>(0, size - kTail));
    return last_line_with_text(
        std::string(std::istreambuf_iterator<char>(log), std::istreambuf_iterator<char>()));
}

}  // namespace puckloop::linuxboard
