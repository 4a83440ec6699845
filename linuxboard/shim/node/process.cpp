#include "linuxboard/shim/node/process.h"

#include <fmt/format.h>

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace puckloop::linuxboard {

namespace {
constexpr double kLookInterval = 0.5;  // s of wall clock between looks at a program that keeps silent
constexpr double kLoadedHostFactor = 10.0;
constexpr double kNanosecondsPerSecond = 1e9;
constexpr int kNanosecondsPerMillisecond = 1'000'000;
/// So soon at the latest it is noticed that a program has died.
constexpr std::int64_t kMoment = 5'000'000;  // ns
constexpr int kEndAttempts = 2000;
constexpr useconds_t kEndPause = 1000;  // together 2 s

/// For Turn.
struct Host {
    template <typename... Arguments>
    static long call(long number, Arguments... arguments) {
        return syscall(number, arguments...);
    }
    static std::int64_t nanoseconds() {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(
                   std::chrono::steady_clock::now().time_since_epoch())
            .count();
    }
};

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

}  // namespace

Process::Process(int socket, wire::ProcessEntry& entry, wire::Channel& channel)
    : socket_(socket), entry_(entry), channel_(channel) {}

void Process::pass_descriptor(int descriptor) {
    char byte = 0;
    iovec part{&byte, sizeof byte};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof descriptor)] = {};
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    cmsghdr* header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
    [[maybe_unused]] const auto sent = sendmsg(socket_, &message, MSG_NOSIGNAL);
}

void Process::reply(wire::Reply reply, const std::vector<FinishedCall>& calls, int passed) {
    // A program that has just died is noticed when it is listened to.
    if (passed >= 0) pass_descriptor(passed);
    std::size_t used = 0;
    reply.count = 0;
    for (const FinishedCall& call : calls) {
        wire::Completion header = call.header;
        header.thread &= 0xffff;  // the number in its process
        if (used + sizeof header + call.data.size() > wire::Channel::kReplyRoom) {
            reply.more = 1;
            channel_.reply = reply;
            channel_.turn.pass<Host>(Turn::Program);
            while (!await_request())
                if (is_gone()) return;
            used = reply.count = reply.more = 0;
        }
        std::memcpy(channel_.reply_data + used, &header, sizeof header);
        used += sizeof header;
        if (!call.data.empty()) std::memcpy(channel_.reply_data + used, call.data.data(), call.data.size());
        used += call.data.size();
        ++reply.count;
    }
    channel_.reply = reply;
    channel_.turn.pass<Host>(Turn::Program);
}

/// False if it is still the program's turn after a moment.
bool Process::await_request() {
    if (!leaving_) return channel_.turn.await<Host>(Turn::Node, patience_, kMoment);
    // No more requests: what comes next is its end, with which its socket closes.
    pollfd entry{socket_, 0, 0};
    poll(&entry, 1, kMoment / kNanosecondsPerMillisecond);
    return channel_.turn.is(Turn::Node);
}

bool Process::is_gone() const {
    siginfo_t ended{};
    const bool is_child =
        host() > 0 && waitid(P_PID, static_cast<id_t>(host()), &ended, WEXITED | WNOHANG | WNOWAIT) == 0;
    if (is_child && ended.si_pid != 0) return true;
    if (is_child && !leaving_) return false;
    pollfd entry{socket_, 0, 0};
    return poll(&entry, 1, 0) == 1;
}

bool Process::was_killed() const {
    siginfo_t ended{};
    return !ended_ && host() > 0 &&
           waitid(P_PID, static_cast<id_t>(host()), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid != 0 && ended.si_code != CLD_EXITED;
}

ProcessEvent Process::hear(double watchdog, wire::Request& request, std::string& data) {
    while (true)
        if (const auto heard = try_hear(watchdog, true, request, data)) return *heard;
}

std::optional<ProcessEvent> Process::try_hear(double watchdog, bool wait, wire::Request& request,
                                              std::string& data) {
    if (!(wait ? await_request() : channel_.turn.is(Turn::Node))) {
        if (!wait) return std::nullopt;
        if (!is_gone()) return is_silent(watchdog) ? std::optional(ProcessEvent::Silent) : std::nullopt;
        if (!channel_.turn.is(Turn::Node)) {
            await_end();
            return ProcessEvent::Ended;
        }
    }
    silence_ = {};
    if (host_ == 0) host_ = entry_.host;
    request = channel_.request;
    data.assign(channel_.request_data, std::min(channel_.request_size, wire::kMaximumData));
    constexpr std::uint32_t kMostThreads = 0xffff;
    request.thread &= kMostThreads;
    if (request.op == wire::Op::Exit) {
        leaving_ = true;
        channel_.turn.give(Turn::Program);
    }
    return ProcessEvent::Request;
}

/// After another moment of waiting in vain.
bool Process::is_silent(double watchdog) {
    silence_.waited += kMoment / kNanosecondsPerSecond;
    const double slice = std::min(watchdog, kLookInterval);
    if (silence_.waited < silence_.looked + slice) return false;
    silence_.looked = silence_.waited;
    // On a loaded host a program that computes may just not get the processor: its own time counts.
    const HostState state = host_state(host());
    if (silence_.computed_before < 0) silence_.computed_before = state.computed_s;
    const bool computed_long = state.computed_s - silence_.computed_before + slice >= watchdog;
    const bool slept_long = state.code != 'R' && silence_.waited >= watchdog;
    return computed_long || slept_long || silence_.waited >= watchdog * kLoadedHostFactor;
}

void Process::await_end() {
    // The link closes a moment before the process is gone. One that lives on without it cannot be conducted.
    for (int attempt = 0; attempt < kEndAttempts && !ended_; ++attempt) {
        reap(false);
        if (!ended_) usleep(kEndPause);
    }
    lost_ = !ended_;
    kill();
}

void Process::reap(bool wait) {
    if (ended_) return;
    const pid_t reaped = host() > 0 ? waitpid(host(), &wait_status_, wait ? 0 : WNOHANG) : -1;
    if (reaped == 0) return;
    ended_ = true;
    if (reaped > 0)
        exit_status_ = WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : 128 + WTERMSIG(wait_status_);
    close(socket_);
    socket_ = -1;
}

void Process::kill() {
    if (ended_) return;
    if (host() > 0) {
        ::kill(-host(), SIGKILL);
        ::kill(host(), SIGKILL);
    }
    reap(true);
}

std::string Process::describe_end() const {
    if (lost_) return "went out of simulated time (it closed the library's files)";
    if (WIFSIGNALED(wait_status_)) {
        const int signal = WTERMSIG(wait_status_);
        return fmt::format("was killed by SIG{} ({})", sigabbrev_np(signal), sigdescr_np(signal));
    }
    return fmt::format("exited with status {}", WEXITSTATUS(wait_status_));
}

int Process::killed_by() const {
    return WIFSIGNALED(wait_status_) ? WTERMSIG(wait_status_) : 0;
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
    for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", host()), none)) {
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

/// "program+0x1234", as the process's memory is mapped; the bare address where nothing is.
static std::string place_in(pid_t process, std::uint64_t address) {
    std::ifstream maps(fmt::format("/proc/{}/maps", process));
    for (std::string line; std::getline(maps, line);) {
        unsigned long long begin = 0, end = 0, offset = 0;
        int name = 0;
        if (std::sscanf(line.c_str(), "%llx-%llx %*s %llx %*s %*s %n", &begin, &end, &offset, &name) < 3)
            continue;
        if (address < begin || address >= end || name == 0) continue;
        const std::string file =
            std::filesystem::path(line.substr(static_cast<std::size_t>(name))).filename();
        return fmt::format("{}+0x{:x}", file, address - begin + offset);
    }
    return fmt::format("0x{:x}", address);
}

std::string Process::describe_silence() const {
    const std::uint64_t faults = entry_.faults.load();
    constexpr std::uint64_t kLoop = 100;
    if (faults >= kLoop && entry_.fault_time == entry_.now.load()) {
        const char* name = sigabbrev_np(static_cast<int>(entry_.fault_signal));
        return fmt::format(
            "it loops in its own handler of SIG{}, which returns to the instruction that failed: {} "
            "times at {}, about the address 0x{:x}",
            name != nullptr ? name : "?", faults, place_in(host(), entry_.fault_place), entry_.fault_address);
    }
    const char state = host_state(host()).code;
    const char* call = entry_.call_name[0] != '\0' ? entry_.call_name : "its start";
    return fmt::format("{}; last call taken over: {} by thread {}",
                       state == 'R' ? "it computes without any call that lets time pass"
                                    : "it waits in a call that is outside of simulated time",
                       call, entry_.thread.load());
}

}  // namespace puckloop::linuxboard
