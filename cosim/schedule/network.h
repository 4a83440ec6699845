#pragma once
// Who is connected to whom: links resolved to nodes and ports, with what waits on them and what harms them.

#include "cosim/core/link.h"
#include "cosim/faults/faults.h"
#include "cosim/schedule/bounds.h"
#include "cosim/schedule/node_handle.h"
#include "cosim/schedule/wire_record.h"
#include "cosim/trace/trace.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// One direction of one link.
struct Wire {
    std::uint16_t link = 0;
    Direction direction = Direction::FromA;
    std::size_t from = 0;
    PortIndex from_port = 0;
    std::size_t to = 0;
    PortIndex to_port = 0;
    bool is_uart = false;
    Time flight = 0;
    Time latency = 0;
    bool is_i2c = false;
    std::uint64_t sequence = 0;
    std::uint64_t sent = 0;  ///< messages that are final
    std::vector<LinkFault*> faults{};
    /// What its sender, which runs ahead, has sent since its mark, and how much of that is final and was
    /// delivered. Where there are faults the rest is not known to the receiver before.
    std::vector<Message> foreseen{};
    std::size_t settled = 0;
    Time base = 0;  ///< nothing but what is foreseen is delivered before, as the sender reported
    /// The channel on which faults bring messages back to the sender, and how many they brought.
    std::size_t loop = kNobody;
    std::uint64_t brought_back = 0;
    std::unique_ptr<WireState> record{};  ///< if the run is to be saved: what was sent, and what arrived
};

/// In the sequence of a message that was brought back to its sender: apart from the other end's own, whose
/// order among them is open.
inline constexpr std::uint64_t kBroughtBack = std::uint64_t{1} << 63;

/// What a node is to receive became another from `time` on, by what `from` sent.
struct Change {
    std::size_t from = 0;
    std::size_t to = 0;
    Time time = 0;
};

class Network {
  public:
    /// Throws InputError for links and faults that name what is not there, or do not fit.
    Network(const std::vector<std::unique_ptr<NodeHandle>>& nodes, const std::vector<LinkSpec>& links,
            const std::vector<FaultSpec>& faults, std::uint64_t seed);

    /// Takes over what node `n`, whose last reply covers everything before `reached`, states of its future.
    /// What it said before still holds, as far as `first_in`, the first message it took since, lets it.
    /// Before that take_sent() has taken what it sent.
    void update(std::size_t n, const NodeState& state, Time reached, Time first_in);
    /// Takes over what node `n` states of its future after it was asked to wind up at `now`, which all nodes
    /// have reached: what it said before holds no more.
    void renew(std::size_t n, const NodeState& state, Time now);
    /// One for each wire, by its index, then those that lead back to their senders.
    const std::vector<Channel>& channels() const { return channels_; }
    /// What comes back of what node `n` sends on each port, as the others stand now.
    void echoes(std::size_t n, std::vector<PortEcho>& echoes);

    /// Takes what node `n` has sent since the mark before its last one: `done.sure` messages are final, the
    /// others foreseen. Appends what final messages become to `deliveries` (lost ones too), and the receivers
    /// of those foreseen to `changes`. `first_in` is the first message that the node had to answer, or
    /// kNever. Throws RunError when a message is earlier than the node's EOT.
    void take_sent(std::size_t n, const std::vector<Message>& outbox, const Advanced& done, Time first_in,
                   std::vector<TraceRecord>& deliveries, std::vector<Change>& changes);
    /// take_sent() and update() in one, for a node that has not run ahead since: everything it sent is final.
    void take_final(std::size_t n, const std::vector<Message>& outbox, Time reached, Time first_in,
                    std::vector<TraceRecord>& deliveries, std::vector<Change>& changes);
    /// Delivers what is foreseen and cannot change any more.
    void settle(const Bounds& bounds, std::vector<TraceRecord>& deliveries, std::vector<Change>& changes);
    /// The first instant after everything that is final although its sender may still go back before it.
    Time after_settled() const;
    /// Appends what is foreseen for node `n` before `until`, in the order of the trace.
    void foreseen(std::size_t n, Time until, std::vector<TraceRecord>& inbox) const;
    /// The first message foreseen for node `n` from `from` on; `heard` is lowered to the first by a wire of a
    /// bus (Channel::takes_turns).
    Time first_foreseen(std::size_t n, Time from, Time& heard) const;
    bool takes_turns(const TraceRecord& record) const {
        return channels_[record.link * 2u + static_cast<unsigned>(record.direction)].takes_turns;
    }
    /// What faults put on the lines by themselves.
    void preset(std::vector<TraceRecord>& deliveries, std::vector<Change>& changes);

    /// For snapshots (network_snapshot.cpp). From now on keeps what they need, before anything is sent;
    /// `has_state`: of each node, whether it can be saved.
    void keep_record(const std::vector<bool>& has_state);
    /// All wires as they are, in their order.
    std::vector<WireState> save() const;
    /// Brings the wires to where `saved` was saved, at `time`: what was sent goes through today's faults
    /// again. `has_state`: as of the run that saved. Gives what arrived at nodes without a state before
    /// `time`, and what is in flight then, of which `in_flight` is what the run that saved had. Throws
    /// InputError if the links are others, or a fault makes another beginning.
    struct Restored {
        std::vector<TraceRecord> arrived;    ///< at nodes without a state, in the order of the trace
        std::vector<TraceRecord> in_flight;  ///< lost messages too
    };
    Restored restore(const std::vector<WireState>& saved, const std::vector<TraceRecord>& in_flight,
                     Time time, const std::vector<bool>& has_state, std::uint64_t unlinked);
    std::size_t wire_count() const { return wires_.size(); }
    const std::vector<Wire>& wires() const { return wires_; }
    /// Where what is sent by a port goes, or kNobody.
    std::size_t wire_of(std::size_t n, PortIndex port) const { return port_wire_[n][port]; }
    Time delivery(std::size_t w, const Message& message) const {
        return delivery_time(message, wires_[w].flight, wires_[w].latency);
    }

    const Wire& wire(const TraceRecord& record) const {
        return wires_[record.link * 2u + static_cast<unsigned>(record.direction)];
    }
    const std::vector<std::unique_ptr<LinkFault>>& faults() const { return faults_; }
    /// For each fault, the index of its specification.
    const std::vector<std::size_t>& fault_specs() const { return fault_specs_; }
    /// Messages sent by ports without a link.
    std::uint64_t unlinked() const { return unlinked_; }

  private:
    /// Shortest ways from each node to one, and as of which state of the lookaheads.
    struct WaysBack {
        std::uint64_t lookaheads = 0;
        std::vector<Time> distances;
    };

    void attach(const LinkSpec& spec, std::uint16_t link);
    void attach_fault(const FaultSpec& spec, std::size_t index, std::uint64_t seed);
    /// Those of one port of the node that take_sent() is about.
    struct Sent {
        std::vector<Message> messages;
        std::size_t sure = 0;
        Time first_new = kNever;     ///< delivery of the first message that had not been foreseen
        Time first_change = kNever;  ///< delivery of the first message that had been, and is no more
    };

    void check_earliest_output(const Wire& wire, Time stamp, Time delivery, Time first_in) const;
    void take_wire(std::size_t w, Sent& sent, Time ahead, Time first_in, std::vector<TraceRecord>& deliveries,
                   std::vector<Change>& changes);
    std::size_t first_difference(const Wire& wire, const Sent& sent) const;
    void send(Wire& wire, const Message& message, std::vector<TraceRecord>& deliveries,
              std::vector<Change>& changes);
    void check_port(std::size_t n, PortIndex port) const;
    static Time future(const Wire& wire, const PortState& port, Time reached, Time claimed);
    void update_lookahead(std::size_t w, const PortState& port);
    void update_channel(std::size_t w);
    void update_loop(std::size_t w);
    void update_arrival_confidence(Channel& channel, Time base, const Sent& sent) const;
    const std::vector<Time>& distances_to_node(std::size_t n);
    void pass_on(Wire& wire, const Message& message, std::vector<TraceRecord>& deliveries,
                 std::vector<Change>& changes);
    void deliver(Wire& wire, std::vector<TraceRecord>& deliveries, std::vector<Change>& changes);
    std::vector<TraceRecord> send_again(Wire& wire, const SentRecord& sent);
    std::size_t sender_of(const TraceRecord& record) const;
    std::string faults_on(const Wire& wire) const;

    const std::vector<std::unique_ptr<NodeHandle>>& nodes_;
    const std::vector<LinkSpec>& links_;
    std::vector<Wire> wires_;
    std::vector<Channel> channels_;
    std::vector<bool> has_unsettled_;  ///< whether something foreseen on a wire is not final
    std::uint64_t lookaheads_ = 1;     ///< how often one changed
    std::vector<WaysBack> ways_back_;
    std::vector<std::vector<std::size_t>> port_wire_;  ///< node, port -> wire or kNobody
    std::vector<std::unique_ptr<LinkFault>> faults_;
    std::vector<std::size_t> fault_specs_;
    std::vector<std::vector<std::size_t>> into_;  ///< node -> wires that end there
    std::vector<Sent> sent_;                      ///< by port
    std::vector<Delivery> batch_;
    std::uint64_t unlinked_ = 0;
};

}  // namespace puckloop::cosim
