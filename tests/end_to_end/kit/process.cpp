#include "tests/end_to_end/kit/process.h"

#include "tests/kit/files.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace puckloop::tests {

namespace {

constexpr auto kPoll = std::chrono::milliseconds(10);

/// State letter and parent of a process, from /proc/ID/stat; '\0' if there is none.
std::pair<char, pid_t> stat_of(const std::string& id) {
    std::string text = text_of("/proc/" + id + "/stat");
    const auto name_end = text.rfind(") ");
    if (name_end == std::string::npos) return {'\0', 0};
    return {text[name_end + 2], std::atoi(text.c_str() + name_end + 4)};
}

bool alive(char state) {
    return state != '\0' && state != 'Z' && state != 'X';
}

}  // namespace

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<pid_t> children_of(pid_t parent) {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const std::string id = entry.path().filename();
        if (!std::all_of(id.begin(), id.end(), [](char c) { return c >= '0' && c <= '9'; })) continue;
        const auto [state, its_parent] = stat_of(id);
        if (its_parent == parent && alive(state)) found.push_back(std::atoi(id.c_str()));
    }
    return found;
}

bool runs(pid_t process) {
    return alive(stat_of(std::to_string(process)).first);
}

bool all_end(const std::vector<pid_t>& processes, double limit) {
    for (const double begun = wall_seconds(); std::any_of(processes.begin(), processes.end(), runs);) {
        if (wall_seconds() - begun > limit) return false;
        std::this_thread::sleep_for(kPoll);
    }
    return true;
}

std::size_t Ended::error_lines() const {
    return static_cast<std::size_t>(std::count(err.begin(), err.end(), '\n'));
}

Process::Process(const std::vector<std::string>& words, const std::filesystem::path& folder,
                 const std::string& input)
    : out_(folder / "stdout"), err_(folder / "stderr"), begun_(wall_seconds()) {
    std::ofstream(folder / "stdin", std::ios::binary) << input;
    std::vector<char*> arguments;
    for (const std::string& word : words)
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const std::string in = folder / "stdin";
    id_ = fork();
    if (id_ < 0) throw std::runtime_error("fork");
    if (id_ == 0) {
        const int flags = O_WRONLY | O_CREAT | O_TRUNC;
        dup2(open(in.c_str(), O_RDONLY), STDIN_FILENO);
        dup2(open(out_.c_str(), flags, 0666), STDOUT_FILENO);
        dup2(open(err_.c_str(), flags, 0666), STDERR_FILENO);
        // A test runner may have been set to ignore signals; the program under test gets a shell's.
        for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
            std::signal(number, SIG_DFL);
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
}

Process::~Process() {
    if (id_ < 0) return;
    ::kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
}

Ended Process::wait(double limit) {
    if (id_ < 0) return ended_;
    int status = 0;
    pid_t gone = 0;
    while ((gone = waitpid(id_, &status, WNOHANG)) == 0) {
        if (wall_seconds() - begun_ > limit && !ended_.timed_out) {
            ended_.timed_out = true;
            signal(SIGKILL);
        }
        std::this_thread::sleep_for(kPoll);
    }
    id_ = -1;
    ended_.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    ended_.seconds = wall_seconds() - begun_;
    ended_.out = text_of(out_);
    ended_.err = text_of(err_);
    return ended_;
}

void Process::signal(int number) const {
    if (id_ > 0) ::kill(id_, number);
}

std::vector<pid_t> Process::children() const {
    return children_of(id_);
}

}  // namespace puckloop::tests
