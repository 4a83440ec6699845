#pragma once
// One process of the program, as a process of the host: spoken to, watched, ended.

#include "linuxboard/shim/kernel/board_kernel.h"
#include "linuxboard/shim/wire/wire.h"

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace puckloop::linuxboard {

/// What came of waiting for the process.
enum class ProcessEvent { Request, Ended, Silent };

class Process {
  public:
    /// `socket`: this end of its link, closed with the object. `entry` and `channel`, which was new when the
    /// process began, must outlive it; the entry's `host` is set before the process's first request.
    Process(int socket, wire::ProcessEntry& entry, wire::Channel& channel);
    ~Process() { kill(); }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// `passed`: a descriptor that goes along, or -1. The channel's TtyView is set before.
    void reply(wire::Reply reply, const std::vector<FinishedCall>& calls, int passed = -1);
    /// Waits for the next request; Silent after `watchdog` seconds of computing, or of waiting in the host.
    /// After Ended the exit state is known.
    ProcessEvent hear(double watchdog, wire::Request& request, std::string& data);
    /// The same, but nothing if none has come yet; with `wait` after some milliseconds at the latest.
    std::optional<ProcessEvent> try_hear(double watchdog, bool wait, wire::Request& request,
                                         std::string& data);

    /// By a signal, and nobody has listened to it since.
    bool was_killed() const;
    /// SIGKILL, for the whole group of a process that leads one.
    void kill();
    /// "exited with status 3", "was killed by SIGSEGV (Segmentation fault)"; after its end.
    std::string describe_end() const;
    bool ended_well() const { return exit_status_ == 0; }
    /// By a fault of its own: SIGSEGV, SIGABRT and the like.
    bool crashed() const;
    /// The signal that ended it, or 0.
    int killed_by() const;
    /// As waitpid() gives it.
    int wait_status() const { return wait_status_; }
    /// No thread catches, ignores, blocks or waits for `signal`, whose default action ends the program.
    bool dies_of(int signal) const;
    /// What the kernel reports of the process that keeps silent: computing, or in which call.
    std::string describe_silence() const;

    wire::Channel& channel() { return channel_; }

  private:
    bool await_request();
    bool is_silent(double watchdog);
    bool is_gone() const;
    void pass_descriptor(int descriptor);
    void reap(bool wait);
    void await_end();

    int socket_;
    wire::ProcessEntry& entry_;
    /// The host's number of it, or 0; from its first request on, whatever the program writes to its entry.
    pid_t host() const { return host_ > 0 ? host_ : entry_.host; }
    pid_t host_ = 0;
    bool ended_ = false;
    int wait_status_ = 0;
    std::optional<int> exit_status_;
    bool lost_ = false;
    wire::Channel& channel_;
    Patience patience_;
    bool leaving_ = false;  ///< it has announced its exit
    /// Of the request that is waited for; seconds.
    struct Silence {
        double waited = 0.0, looked = 0.0;
        double computed_before = -1.0;
    } silence_;
};

}  // namespace puckloop::linuxboard
