#include "campaigns/jobs/pool.h"

#include "base/error.h"
#include "campaigns/jobs/own_process.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace puckloop::jobs {

namespace {

/// A process of its own, and a socket that is its standard input and output.
class Worker {
  public:
    explicit Worker(const PoolOptions& options) {
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
            throw RunError(fmt::format("no worker: {}", std::strerror(errno)));
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
        const int error = start_self(options.crew.words, actions, id_);
        ::close(ends[1]);
        socket_ = ends[0];
        if (error != 0) {
            ::close(socket_);
            throw RunError(fmt::format("no worker: {}", std::strerror(error)));
        }
    }
    ~Worker() {
        ::close(socket_);
        if (id_ < 0) return;
        ::kill(id_, SIGKILL);
        wait();
    }
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    void give(const Job& one) {
        busy = one;
        std::string line = one.what.dump() + '\n';
        std::size_t done = 0;
        while (done < line.size()) {
            const auto count = ::send(socket_, line.data() + done, line.size() - done, MSG_NOSIGNAL);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return;  // its end is noticed when we read
            done += static_cast<std::size_t>(count);
        }
    }

    /// False at its end.
    bool read(std::string& line) {
        char part[65536];
        const auto count = ::recv(socket_, part, sizeof part, 0);
        if (count < 0 && errno == EINTR) return true;
        if (count <= 0) return false;
        text_.append(part, static_cast<std::size_t>(count));
        if (const auto end = text_.find('\n'); end != std::string::npos) {
            line = text_.substr(0, end);
            text_.erase(0, end + 1);
        }
        return true;
    }

    /// How it ended: "SIGKILL", "status 1".
    std::string wait() {
        int status = 0;
        while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
        }
        id_ = -1;
        if (WIFSIGNALED(status)) return fmt::format("SIG{}", sigabbrev_np(WTERMSIG(status)));
        return fmt::format("status {}", WEXITSTATUS(status));
    }

    int socket() const { return socket_; }
    pid_t id() const { return id_; }

    std::optional<Job> busy;

  private:
    pid_t id_ = -1;
    int socket_ = -1;
    std::string text_;
};

class Pool {
  public:
    Pool(const PoolOptions& options, const std::vector<Job>& jobs, const TakeResult& take)
        : options_(options), waiting_(jobs.begin(), jobs.end()), take_(take) {}

    void run() {
        const auto count = std::min<std::size_t>(static_cast<std::size_t>(options_.jobs), waiting_.size());
        for (std::size_t i = 0; i < count; ++i)
            workers_.push_back(std::make_unique<Worker>(options_));
        for (auto& worker : workers_)
            give_next(*worker);
        while (std::any_of(workers_.begin(), workers_.end(),
                           [](const auto& worker) { return worker->busy.has_value(); }))
            listen();
        if (!problem_.empty()) throw RunError(problem_);
    }

  private:
    void give_next(Worker& worker) {
        worker.busy.reset();
        if (waiting_.empty() || !problem_.empty()) return;
        const Job next = waiting_.front();
        waiting_.pop_front();
        worker.give(next);
    }

    void listen() {
        std::vector<pollfd> sockets;
        for (const auto& worker : workers_)
            sockets.push_back({worker->socket(), POLLIN, 0});
        const int ready = ::poll(sockets.data(), sockets.size(), 500);
        if (options_.interrupted != nullptr && *options_.interrupted != 0)
            throw RunError(
                fmt::format("interrupted (SIG{}); the results so far are kept, the same command goes on",
                            sigabbrev_np(*options_.interrupted)));
        if (ready <= 0) return;
        for (std::size_t i = 0; i < sockets.size(); ++i)
            if (sockets[i].revents != 0) hear(i);
    }

    void hear(std::size_t index) {
        Worker& worker = *workers_[index];
        std::string line;
        if (!worker.read(line)) return replace(index);
        if (line.empty()) return;
        const nlohmann::json result = nlohmann::json::parse(line);
        const Job one = worker.busy.value();
        if (result.contains("problem"))
            try_again(one, result.at("problem"), result.value("killed", false));
        else
            take_(result.at("id"), result.at("verdict"));
        give_next(worker);
    }

    void replace(std::size_t index) {
        const std::optional<Job> lost = workers_[index]->busy;
        const pid_t id = workers_[index]->id();
        const std::string end = workers_[index]->wait();
        if (lost) try_again(*lost, fmt::format("worker {} died ({})", id, end), true);
        workers_[index] = std::make_unique<Worker>(options_);
        give_next(*workers_[index]);
    }

    void try_again(const Job& one, const std::string& why, bool died) {
        if (++tries_[one.id] < kTries) {
            fmt::print(stderr, "puckloop: {} {}: {}: it is run again\n", options_.crew.noun, one.id, why);
            waiting_.push_front(one);
        } else if (died && options_.deadly) {
            take_(one.id,
                  options_.deadly(one, fmt::format("its process died three times, the last so: {}", why)));
        } else if (problem_.empty()) {
            problem_ = fmt::format(
                "{} {} failed {} times: {}; the results so far are kept, the same command goes on",
                options_.crew.noun, one.id, kTries, why);
        }
    }

    const PoolOptions& options_;
    std::deque<Job> waiting_;
    const TakeResult& take_;
    std::vector<std::unique_ptr<Worker>> workers_;
    std::map<int, int> tries_;
    std::string problem_;
};

}  // namespace

void run_local(const PoolOptions& options, const std::vector<Job>& jobs, const TakeResult& take) {
    if (!jobs.empty()) Pool(options, jobs, take).run();
}

}  // namespace puckloop::jobs
