#pragma once
// A node as the conductor sees it, wherever it lives: in this process or in one of its own.

#include "cosim/core/message.h"
#include "cosim/core/node.h"
#include "cosim/core/sampled_inputs.h"
#include "cosim/core/time.h"
#include "cosim/core/work_counts.h"
#include "cosim/schedule/stride.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::cosim {

/// Makes a node from its description; throws InputError when it cannot be made.
using NodeFactory = std::function<std::unique_ptr<Node>(const std::string& json)>;

struct PortState {
    Time earliest_output = 0;
    Time lookahead = 0;
    std::optional<Time> begun;

    friend bool operator==(const PortState&, const PortState&) = default;
};

/// What a node states of its future after each advance.
struct NodeState {
    std::vector<PortState> ports;
    std::optional<Stop> stop;
    Time wound_up = 0;        ///< Node::wound_up
    bool runs_ahead = false;  ///< it can go back (Node::rewindable())
    bool bounded = false;     ///< it can go back from before `horizon` only (BoundedRewindable)
    Time horizon = kNever;
};

/// What came of one grant.
struct Advanced {
    Time reached = 0;      ///< what lies before is final
    Time ahead = 0;        ///< executed so far on what was foreseen; >= reached
    std::size_t sure = 0;  ///< so many messages of the outbox are final, the others foreseen
};

/// Fills `state` from a node in this process, which has not run ahead.
void read_state(const Node& node, NodeState& state);

/// Every call may throw RunError that names the node, the time it had reached and the cause.
class NodeHandle {
  public:
    using Clock = std::chrono::steady_clock;

    virtual ~NodeHandle() = default;

    const std::string& name() const { return name_; }
    const std::vector<Port>& ports() const { return ports_; }
    /// As of the last reply.
    const NodeState& state() const { return state_; }
    /// How far the last reply states it came; messages of its inbox from then on were not taken.
    const Advanced& advanced() const { return advanced_; }
    Time reached() const { return advanced_.reached; }
    /// Messages of the last reply, by the sender's port.
    std::vector<Message>& outbox() { return outbox_; }

    /// Waits until the node is made and has reported its ports and first state.
    virtual void await_ready() = 0;
    /// Asks the node to advance, in strides if `echoes` asks for them (cosim/schedule/stride.h); one grant at
    /// a time. `inbox` and what `echoes` shows stay as they are until the reply is complete.
    virtual void grant(Reach reach, const std::vector<Message>& inbox, std::span<const PortEcho> echoes) = 0;
    /// True once the reply to the last grant is complete. A node in this process does its work here, up to
    /// where it has to wait for a program (Suspendable). `wait` lets it wait for some milliseconds, one
    /// elsewhere for some tenths of a second.
    virtual bool poll(bool wait) = 0;
    /// False where poll() does the work itself.
    virtual bool elsewhere() const { return false; }
    /// What grant() and poll() do with one `until`, in this process and where nothing is foreseen: the short
    /// way for cosim/schedule/windows.h. Of state() only what linked ports state is read, and stop and
    /// wound_up. False: it waits for its program, poll() goes on.
    virtual bool advance(Time until, const std::vector<Message>& inbox) {
        grant({until, until, until}, inbox, {});
        return poll(false);
    }
    /// The node is to be advanced by advance_sampling(); and it only looks at what this port brings.
    bool samples() const { return !sampled_.empty(); }
    bool samples(PortIndex port) const { return port < sampled_.size() && sampled_[port]; }
    /// What leaves by this port does not depend on them (SampledInputs::independent()).
    bool independent(PortIndex port) const { return port < independent_.size() && independent_[port]; }
    /// As advance(), of such a node; advanced() gives how far it came (SampledInputs::advance_sampling()).
    virtual void advance_sampling(const SampledReach& /*reach*/, const std::vector<Message>& /*inbox*/) {}
    /// SampledInputs::turn_port(), and whether it has the turn as of the last advance.
    std::optional<PortIndex> turn_port() const { return turn_port_; }
    bool has_turn() const { return has_turn_; }
    /// The ports that lead somewhere.
    void set_linked(std::vector<PortIndex> ports) { linked_ = std::move(ports); }
    /// Asks the node, which is under no grant, to bring what it runs to an end (Node::wind_up); state() is
    /// then as of after that.
    virtual void wind_up(int signal) = 0;
    /// The node's whole state can be saved and loaded (cosim/core/stateful_node.h).
    bool has_state() const { return has_state_; }
    /// Of a node with a state that is under no grant and has not run ahead: its state at reached().
    virtual std::vector<std::uint8_t> save() = 0;
    /// Into a node with a state that was never granted anything: it stands at `time` then, and state() is as
    /// of there. Throws InputError if the state does not fit.
    virtual void load(Time time, const std::vector<std::uint8_t>& state) = 0;
    /// What the node's work was made of so far, before finish(); empty for one in a process of its own.
    virtual WorkCounts work() const { return {}; }
    /// Ends the node and returns its part of the report as JSON text; empty if it was lost before.
    virtual std::string finish() = 0;
    /// The process it lives in, 0 for this one.
    virtual int process() const { return 0; }

  protected:
    std::string name_;
    std::vector<Port> ports_;
    std::vector<PortIndex> linked_;
    NodeState state_;
    std::vector<Message> outbox_;
    Advanced advanced_;
    bool has_state_ = false;
    std::vector<bool> sampled_;  ///< by port; empty: none is
    std::vector<bool> independent_;
    std::optional<PortIndex> turn_port_;
    bool has_turn_ = false;
};

/// A node in this process.
std::unique_ptr<NodeHandle> make_local_node(const std::string& name, const std::string& json,
                                            const NodeFactory& factory);

}  // namespace puckloop::cosim
