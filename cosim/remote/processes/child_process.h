#pragma once
// A child that dies with its parent and is always reaped.

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// What a child has as standard streams; -1: nothing to read, the parent's output and error.
struct ChildStreams {
    int in = -1, out = -1, error = -1;
};

class ChildProcess {
  public:
    /// Starts `command` (program and arguments) with `descriptors` as 3, 4, ..., in a process group of its
    /// own; ps shows it as `title` and its arguments. The group is its own so that a Ctrl-C at the terminal
    /// reaches the parent alone. The kernel kills it when the parent dies. A program that cannot be executed
    /// exits with status 127. Throws RunError.
    ChildProcess(const std::vector<std::string>& command, const std::string& title,
                 std::span<const int> descriptors, const ChildStreams& streams = {});
    /// Kills the whole group and reaps the child.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    pid_t id() const { return id_; }
    /// True once it has ended; waits at most `patience` of wall time.
    bool ended(std::chrono::milliseconds patience);
    /// "was killed by signal 9 (Killed)", "exited with status 3", "still runs".
    std::string ending() const;

  private:
    void reap();

    pid_t id_ = 0;
    std::optional<int> status_;
};

}  // namespace puckloop::cosim
