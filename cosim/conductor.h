#pragma once
// The conductor: owns simulated time for every node of a run. See docs/architecture.md, "The conductor".

#include "cosim/core/link.h"
#include "cosim/core/time.h"
#include "cosim/faults/faults.h"
#include "cosim/schedule/node_handle.h"
#include "cosim/trace/link_stats.h"
#include "cosim/trace/trace.h"

#include <csignal>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::cosim {

class NodeHosts;     // cosim/remote/node_hosts.h
struct RunSnapshot;  // cosim/resume/run_snapshot.h

struct NodeSpec {
    std::string name;  ///< unique in the run: "robot0.pic"
    std::string json;  ///< what the factory makes the node from
    /// Where this node lives, if not as the run's option states.
    std::optional<bool> in_process{};
    /// Any thread may advance it: it has nothing to do with processes, signals or other nodes' state.
    bool any_thread = false;
    /// It speaks for something that cannot be repeated. Where it is executed again (RunOptions::from), what
    /// it sent then stands.
    bool outside = false;
    /// With RunOptions::hosts: where it lives; 0: as without.
    unsigned host = 0;
};

struct Progress {
    Time time = 0;      ///< reached by every node
    double wall_s = 0;  ///< since the run began
    double factor = 0;  ///< simulated seconds per wall second over the last report interval
};

struct RunOptions {
    Time duration = kNever;
    bool in_process = false;
    /// Where every node is in this process: they go side by side, a window at a time, and none runs ahead
    /// (cosim/schedule/windows.h). The trace is the same. Not with `realtime`.
    bool windows = false;
    bool realtime = false;           ///< simulated time never runs ahead of the wall clock
    Time pace_from = 0;              ///< with realtime: what lies before runs as fast as it can
    std::uint64_t seed = 1;          ///< for the faults' random streams
    unsigned threads = 1;            ///< of this process, for nodes that any thread may advance
    bool threads_if_faster = false;  ///< more than one work only while that is faster
    double stall_seconds = 10.0;     ///< a node process that does not answer for so long ends the run
    /// A node's request to end the run (Node::stop) takes effect so much later; no node runs further ahead.
    Time stop_latency = 10 * kMillisecond;
    /// Starts a process that serves one node (cosim/remote/processes/node_server.h) on descriptors 3 and 4;
    /// in place of the program's name it gets "puckloop: " and the node's, which is what ps shows.
    std::vector<std::string> node_command{"/proc/self/exe"};
    /// Processes that serve nodes; they outlive the conductor. All nodes that are on none of them are in this
    /// process.
    NodeHosts* hosts = nullptr;
    /// Cuts grants at random places; the trace must not change (for tests).
    std::optional<std::uint64_t> chop_seed{};
    /// When snapshots are taken, rising; `save` gets each, without build, origin and trace. A run that ends
    /// before has none.
    std::vector<Time> save_at{};
    std::function<void(RunSnapshot&)> save{};
    /// When the next snapshot after this time is due besides those; kNever: none.
    std::function<Time(Time)> save_next{};
    /// When the run stands still next after this time, without a snapshot; kNever: not any more. All nodes
    /// are at exactly that time then, and all that came before is in the trace. `stand` may take a snapshot
    /// there, and give the run up by throwing Reverted.
    std::function<Time(Time)> stand_next{};
    std::function<void(Time, const std::function<RunSnapshot()>& snapshot)> stand{};
    /// The run goes on from here, of the same nodes and links; faults may be others, if they begin later.
    const RunSnapshot* from = nullptr;
    /// Called about five times a wall second.
    std::function<void(const Progress&)> progress{};
    /// Set by a signal handler to the signal's number: ends the run after the nodes wound up
    /// (cosim/interrupt.h).
    const volatile std::sig_atomic_t* interrupted = nullptr;
    /// Set by a second signal: ends the run at once.
    const volatile std::sig_atomic_t* abort_requested = nullptr;
};

enum class EndReason : std::uint8_t { Duration, NodeStopped, Interrupted, Failed, Reverted };

/// Thrown out of the advance() of a node in the conductor's process: the run is given up as it stands, for
/// its owner to begin it again from a snapshot. Nodes are not finished, and the outcome states
/// EndReason::Reverted and nothing else.
struct Reverted {};

struct Outcome {
    EndReason reason = EndReason::Duration;
    bool success = true;            ///< false for Failed and for a node that stopped without success
    std::string text;               ///< one line: why the run ended; for Failed the error to report
    std::string node;               ///< the node that stopped or failed, if one did
    std::optional<Time> stop_time;  ///< when the node asked, or where in simulated time the user interrupted
    std::optional<Time> wind_up;    ///< when the nodes were asked to end, if any took time for it
    Time simulated = 0;             ///< reached by every node
    double wall_s = 0;
    bool went_on = false;      ///< from a snapshot
    double restored_s = 0;     ///< of these: bringing the nodes to where the run goes on from
    std::uint64_t grants = 0;  ///< to all nodes together (differs with placement and load)
    std::string trace_sha256;

    struct NodeReport {
        std::string name;
        std::string json;          ///< from Node::finish(); empty if the node could not give it
        std::uint64_t grants = 0;  ///< differs with placement and load
        WorkCounts work{};         ///< the same; empty for a node in a process of its own
    };
    struct LinkReport {
        std::string name;
        std::string a, b;  ///< "node.port"
        LinkStats from_a, from_b;
    };
    std::vector<NodeReport> nodes;
    std::vector<LinkReport> links;
    std::vector<FaultReport> faults;    ///< in their order; of nodes' faults without what those have to say
    std::vector<std::string> warnings;  ///< messages by ports without a link
};

/// Runs nodes to the end. Nodes are made by the constructor, which throws InputError for anything that does
/// not fit together and RunError when a node process cannot be started. run() never throws for what happens
/// during the run: a node that dies, stalls or lies, or a sink that fails, is reported in the outcome, after
/// everything recorded was flushed and the other nodes had their chance to finish.
class Conductor {
  public:
    /// `factory` makes the nodes of this process; node processes have their own.
    Conductor(std::vector<NodeSpec> nodes, std::vector<LinkSpec> links, std::vector<FaultSpec> faults,
              RunOptions options, NodeFactory factory);
    ~Conductor();
    Conductor(const Conductor&) = delete;
    Conductor& operator=(const Conductor&) = delete;

    /// `sink` must outlive run().
    void add_sink(TraceSink& sink);
    /// Process of node `name`, 0 if it lives in this one.
    int process_of(const std::string& name) const;

    Outcome run();

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace puckloop::cosim
