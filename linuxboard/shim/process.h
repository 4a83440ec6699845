#pragma once
// The program as a process of the host: started under the preloaded library, spoken to, watched, ended.

#include "linuxboard/shim/board_kernel.h"
#include "linuxboard/shim/spec.h"
#include "linuxboard/shim/wire.h"

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace puckloop::linuxboard {

/// What came of waiting for the program.
enum class Heard { Request, Ended, Silent };

class Process {
  public:
    /// Checks the program; starts nothing yet. Throws InputError.
    explicit Process(const LinuxSpec& spec);
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// Starts the program, which waits in the library until the first reply. Throws InputError if it cannot
    /// be executed, RunError if the host refuses.
    void start();
    bool running() const { return pid_ > 0; }

    void reply(const wire::Reply& reply, const std::vector<FinishedCall>& calls);
    /// Waits for the next request; Silent after `watchdog` seconds of computing, or of waiting in the host.
    /// After Ended the exit state is known.
    Heard hear(double watchdog, wire::Request& request, std::string& data);

    void kill();
    /// What the program wrote to its log since the last call goes to this terminal too.
    void echo_output();
    /// "exited with status 3", "was killed by SIGSEGV (Segmentation fault)"; after its end.
    std::string describe_end() const;
    bool ended_well() const { return exit_status_ == 0; }
    /// By a fault of its own: SIGSEGV, SIGABRT and the like.
    bool crashed() const;
    /// No thread catches, ignores, blocks or waits for `signal`, whose default action ends the program.
    bool dies_of(int signal) const;
    /// What the kernel says of the program that keeps silent: computing, or in which call.
    std::string describe_silence() const;
    const wire::Page& page() const { return *page_; }
    /// Host CLOCK_MONOTONIC at simulated time 0, nanoseconds; 0 until set (real-time mode).
    std::int64_t& wall_origin() { return page_->wall_origin; }
    /// Last line the program wrote to its log, if there is a log file.
    std::string last_line() const;

  private:
    void prepare_page();
    void reap(bool wait);
    void await_end();

    const LinuxSpec& spec_;
    std::string file_;
    std::string shim_;
    wire::Page* page_ = nullptr;
    int page_fd_ = -1;
    int socket_ = -1;
    int log_fd_ = -1;
    off_t echoed_ = 0;
    pid_t pid_ = -1;
    int wait_status_ = 0;
    std::optional<int> exit_status_;
    bool lost_ = false;
    std::vector<char> buffer_;
    std::string out_;
};

}  // namespace puckloop::linuxboard
