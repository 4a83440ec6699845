#pragma once
// The conductor's state and the loop over it; private to its source files: conductor.cpp (the loop),
// conductor_grants.cpp (what is granted, what is replied), conductor_work.cpp (who does the work),
// conductor_trace.cpp (what becomes of the trace), conductor_snapshot.cpp (a run saved, and gone on with),
// conductor_end.cpp (how a run ends, what is reported of it).

#include "base/random.h"
#include "cosim/conductor.h"
#include "cosim/core/wall_clock.h"
#include "cosim/remote/processes/node_processes.h"
#include "cosim/schedule/network.h"
#include "cosim/schedule/schedule.h"
#include "cosim/schedule/trial.h"
#include "cosim/schedule/windows.h"
#include "cosim/schedule/workers.h"
#include "cosim/trace/trace_hash.h"
#include "cosim/trace/trace_merger.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::cosim {

/// Looks at several programs before one of them is waited for; some 20 us.
inline constexpr int kLooksAtSeveral = 100;

/// For heaps of what waits, earliest first.
inline bool after(const TraceRecord& a, const TraceRecord& b) {
    return a.key() > b.key();
}

class Conductor::State {
  public:
    State(std::vector<NodeSpec> nodes, std::vector<LinkSpec> links, std::vector<FaultSpec> faults,
          RunOptions options, const NodeFactory& factory);

    Outcome run();

    std::vector<TraceSink*> sinks;
    const std::vector<std::unique_ptr<NodeHandle>>& handles() const { return handles_; }

  private:
    /// What has been asked of a node and what waits for it.
    struct Slot {
        Time asked = 0;
        Time asked_ahead = 0;  ///< how far to run ahead
        std::uint64_t grants = 0;
        Time unknown = kNever;  ///< first message that the node does not know of
        Time changed = kNever;  ///< first change in what comes in since the grant under way
        std::size_t changed_by = kNobody;
        Time span = 0;                   ///< to be executed for the grant under way, in simulated time
        bool stale = true;               ///< `unknown` is to be found again
        std::vector<TraceRecord> queue;  ///< final and not handled; heap, earliest first
        std::vector<TraceRecord> taken;  ///< what comes in, for the grant under way
        std::vector<Message> inbox;      ///< the same, as the node gets it
        std::vector<TraceRecord> left;   ///< what it did not take
        Time known = kNever;             ///< of a node with SampledInputs: SampledReach
        Time answered = kNever;          ///< the same
        std::vector<PortEcho> echoes;
        bool before_look = false;  ///< left windows ahead of what it looks at (SampledInputs)
        bool stop_seen = false;
        bool wound_up = false;
        double pace = 0.0;  ///< wall ns that a simulated ps takes it, about

        /// Takes what is queued before `until` off, in the order of the trace.
        template <class Take>
        void take_before(Time until, Take take) {
            while (!queue.empty() && queue.front().time < until) {
                take(queue.front());
                std::pop_heap(queue.begin(), queue.end(), after);
                queue.pop_back();
            }
        }
        double expected_ns() const { return pace * static_cast<double>(span); }
        void worked(double ns) {
            if (span > 0) pace += (ns / static_cast<double>(span) - pace) / kPaceMemory;
        }
        static constexpr double kPaceMemory = 8.0;
    };

    /// To the end, or to where the run pauses if that is earlier.
    void loop();
    Time pause_or_end() const { return std::min(end_, pause_); }
    // Of whichever loop is under way.
    Time floor() const { return in_windows_ ? windows_.floor() : schedule_.bounds().floor(); }
    Time reached() const { return in_windows_ ? windows_.reached() : schedule_.reached(); }
    // conductor_snapshot.cpp
    void begin_anew();
    void run_and_save();
    Time next_save(Time after) const;
    void keep_record();
    Time next_stand(Time after) const;
    RunSnapshot snapshot(Time time);
    void go_on_from(const RunSnapshot& from);
    void execute_again(const RunSnapshot& from, const std::vector<TraceRecord>& arrived);
    void take_stops(const RunSnapshot& from);
    void take_interrupt();
    void wind_up();
    void take_wound_up(std::size_t n, Time before);
    ScheduleLimits limits();
    void plan();
    void grant(std::size_t n, Time until, Time ahead);
    bool follow_up();
    void chop(std::size_t n, Time& until, Time& ahead);
    // conductor_windows.cpp
    void loop_in_windows();
    std::vector<Windows::Sampling> sampled_channels() const;
    void find_pending();
    void show_sampled();
    void show_sampled(const TraceRecord& record);
    void leave_windows();
    void window();
    void share_window();
    void advance_shares();
    bool advance_in_window(std::size_t n);
    void advance_sampling(std::size_t n);
    void resume_in_window();
    void take_window(std::size_t n);
    void collect();
    bool work_here();
    void share_out();
    bool work(std::size_t n, bool wait);
    void resume(bool wait);
    void await_work();
    void take_local_reply(std::size_t n);
    void take_done();
    void collect_elsewhere(bool wait);
    void take_reply(std::size_t n);
    void take_stop(std::size_t n, Time before);
    void end_with(const Stop& stop, std::size_t n);
    bool may_run_ahead(std::size_t n);
    void find_unknown(std::size_t n);
    void take_turns();
    void fill_inbox(std::size_t n, Time until);
    void take_deliveries(std::size_t sender);
    void take_changes();
    void surprise(std::size_t from, std::size_t to, Time time);
    [[noreturn]] void too_late(std::size_t sender, std::size_t to, Time time) const;
    // conductor_trace.cpp
    void release_trace(Time floor);
    void release_trace_beside(Time floor);
    void write_trace();
    void take_written();
    void finish_trace();
    /// Among the pieces of work that helpers get, besides the nodes.
    std::size_t trace_piece() const { return handles_.size(); }
    std::size_t share_piece() const { return handles_.size() + 1; }  ///< the first of as many as helpers

    void report_progress();
    bool stuck() const;
    [[noreturn]] void deadlock() const;
    void fail(Outcome& outcome, const std::string& text);
    void finish(Outcome& outcome);
    void report(Outcome& outcome);

    std::vector<NodeSpec> specs_;
    std::vector<LinkSpec> links_;
    std::vector<FaultSpec> fault_specs_;
    RunOptions options_;
    std::unique_ptr<NodeProcesses> processes_;  ///< once there is a node in a process of its own
    bool elsewhere_too_ = false;                ///< not all nodes are in this process
    std::vector<std::unique_ptr<NodeHandle>> handles_;
    std::unique_ptr<Network> network_;

    std::vector<NodeTimes> times_;
    std::vector<Slot> slots_;
    std::vector<Time> pending_, acting_;
    Schedule schedule_;
    Windows windows_;
    std::vector<std::size_t> shares_;  ///< nodes of a window that any thread may advance
    std::atomic<std::size_t> next_share_{0};
    bool in_windows_ = false;  ///< the loop is that of conductor_windows.cpp
    std::vector<TraceRecord> deliveries_;
    std::vector<Change> changes_;
    std::vector<LinkStats> stats_;        ///< one a wire
    std::vector<std::size_t> surprised_;  ///< since the plan
    std::vector<std::size_t> following_;
    std::vector<std::size_t> replied_;  ///< nodes that have replied since the plan or the last look
    bool others_run_ahead_ = false;     ///< some node has that may go as far as it likes
    TraceMerger merger_;
    TraceHash hash_;
    std::vector<TraceRecord> batch_;    ///< being written by whatever thread
    bool writing_ = false;              ///< batch_, the sinks and stats_ are not this thread's
    std::size_t written_ = 0;           ///< of batch_
    std::exception_ptr trace_failure_;  ///< of the sinks
    bool trace_ended_ = false;          ///< by a failure: what came after it would leave a gap
    std::optional<RandomStream> chop_;
    std::unique_ptr<Workers> workers_;
    std::optional<Trial> thread_trial_;         ///< of whether helpers serve
    std::vector<std::size_t> here_;             ///< nodes of this process just granted, for this thread
    std::vector<std::size_t> suspended_;        ///< nodes of this process that wait for their programs
    std::vector<std::size_t> elsewhere_;        ///< nodes of other processes that are granted
    std::vector<std::size_t> shared_;           ///< those just granted that any thread may advance
    std::vector<std::size_t> done_;             ///< that any thread has
    std::vector<std::exception_ptr> failures_;  ///< of nodes, by index

    Time end_ = kNever;
    Time pause_ = kNever;  ///< for a snapshot
    bool went_on_ = false;
    double restored_s_ = 0;
    std::vector<std::pair<Stop, std::size_t>> stop_requests_;  ///< to stop together, and whose
    std::optional<Stop> stop_;
    std::size_t stop_requester_ = kNobody;
    std::optional<Time> interrupted_at_;
    std::optional<Time> wind_up_at_;  ///< the nodes are winding up since
    std::size_t winding_ = 0;         ///< so many still do
    Time last_wound_up_ = 0;
    std::size_t current_ = kNobody;  ///< whose call is under way: names the one that failed
    std::uint64_t grants_ = 0;
    WallClock::time_point start_{};
    WallClock::time_point plan_begun_{}, planned_at_{};  ///< the last plan and its grants
    std::optional<WallClock::time_point> paced_since_;   ///< RunOptions::pace_from was reached
    double last_progress_wall_ = 0.0;
    double flushed_wall_ = 0.0;
    Time last_progress_time_ = 0;
};

}  // namespace puckloop::cosim
