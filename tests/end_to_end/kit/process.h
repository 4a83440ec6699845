#pragma once
// A process under test: started, waited for with a time limit, signalled; nothing of it outlives the test.

#include "tests/kit/files.h"

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace puckloop::tests {

struct Ended {
    int status = -1;         ///< exit status, or 128 + signal
    bool timed_out = false;  ///< it was killed because it took too long
    double seconds = 0;      ///< of wall time, from its start
    std::string out;
    std::string err;

    /// Lines on standard error.
    std::size_t error_lines() const;
};

class Process {
  public:
    /// Starts `words`; standard output and error go to files in `folder`, standard input is empty or `input`.
    Process(const std::vector<std::string>& words, const std::filesystem::path& folder,
            const std::string& input = {});
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// Waits until it ends; after `limit` wall-clock seconds it is killed. Asked again: the same answer.
    Ended wait(double limit = 120.0);
    void signal(int number) const;
    pid_t id() const { return id_; }
    /// Processes that it started and that run.
    std::vector<pid_t> children() const;

  private:
    std::filesystem::path out_, err_;
    pid_t id_ = -1;  ///< -1: it ended and was waited for
    double begun_ = 0;
    Ended ended_;
};

/// Children of `parent` that run (zombies do not count).
std::vector<pid_t> children_of(pid_t parent);
/// The process runs (a zombie does not).
bool runs(pid_t process);
/// None of them runs any more, at the latest after `limit` wall-clock seconds: what a killed run leaves ends
/// by itself, when it sees that its conductor is gone.
bool all_end(const std::vector<pid_t>& processes, double limit = 10.0);
double wall_seconds();

}  // namespace puckloop::tests
