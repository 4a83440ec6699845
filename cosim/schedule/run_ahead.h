#pragma once
// Runs a node ahead of the time granted to it, on what is known to come in, and takes that back when it was
// wrong. The same for a node in this process and for one in its own.
//
// A grant reaches to `until`, before which the inbox is final, and on to `ahead`, before which the inbox is
// what is foreseen: messages that are on their way, or that other nodes running ahead are going to send. The
// node is marked at `until` and executed on to `ahead`. What it sends there is handed out as foreseen too. If
// a later grant brings the same inbox, nothing is executed again; if not, the node goes back to its mark.
// Only what truly comes in decides what becomes final, so no trace depends on how far a node ran ahead.

#include "cosim/core/bounded_rewindable.h"
#include "cosim/core/message.h"
#include "cosim/core/node.h"
#include "cosim/core/sampled_inputs.h"
#include "cosim/core/stateful_node.h"
#include "cosim/core/work_counts.h"
#include "cosim/schedule/node_handle.h"
#include "cosim/schedule/stride.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace puckloop::cosim {

class RunAhead {
  public:
    explicit RunAhead(std::unique_ptr<Node> node)
        : node_(std::move(node)),
          stateful_(dynamic_cast<StatefulNode*>(node_.get())),
          sampling_(dynamic_cast<SampledInputs*>(node_.get())),
          bounded_(dynamic_cast<const BoundedRewindable*>(node_->rewindable())) {}

    const Node& node() const { return *node_; }
    Time reached() const { return reached_; }
    bool can_go_back() const { return node_->rewindable() != nullptr; }

    /// `inbox` is sorted by time and holds everything known from the time reached before until `reach.ahead`.
    /// A node that cannot go back takes what comes before reach.until, in strides as `echoes` say. With
    /// reach.ahead == reach.until nothing is foreseen any more. In place of what `outbox` held: everything
    /// sent since the mark that the last call left; how much of it is final is part of the answer.
    Advanced advance(const Reach& reach, std::span<const Message> inbox, std::span<const PortEcho> echoes,
                     std::vector<Message>& outbox);

    /// As advance(), but nothing where the node would wait for something outside of simulated time
    /// (Suspendable): resume() then goes on. The inbox may go, the outbox must stay.
    std::optional<Advanced> begin(const Reach& reach, std::span<const Message> inbox,
                                  std::span<const PortEcho> echoes, std::vector<Message>& outbox);
    /// After begin() gave nothing. `wait`: lets the node wait for some milliseconds.
    std::optional<Advanced> resume(bool wait, std::vector<Message>& outbox);

    /// The short way for a node that has not run ahead and does not leave its advance() (Suspendable): up to
    /// `until`, before which the whole inbox lies. What it sent is final, in place of what `outbox` held.
    void advance_to(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
        outbox.clear();
        node_->advance(until, inbox, outbox);
        note_advance(reached_, until, inbox.size());
        reached_ = ahead_ = until;
    }

    /// The same for a node that only looks at some inputs, to where it comes.
    const SampledInputs* sampling() const { return sampling_; }
    void advance_sampling(const SampledReach& reach, std::span<const Message> inbox,
                          std::vector<Message>& outbox) {
        outbox.clear();
        const Time before = reached_;
        reached_ = ahead_ = sampling_->advance_sampling(reach, inbox, outbox);
        note_advance(before, reached_, inbox.size());
    }

    /// What the node states of its future, having run ahead: its EOTs are beyond what is foreseen, its
    /// lookaheads hold for whatever else comes in from the time reached on.
    void read_state(NodeState& state) const;

    /// Node::wind_up() at the time reached; nothing may be foreseen.
    void wind_up(int signal);
    /// What was run ahead is taken back.
    std::string finish();
    /// What it took so far, and of what the node itself counts.
    WorkCounts work() const;

    /// The node's whole state can be saved and loaded.
    bool has_state() const { return stateful_ != nullptr; }
    /// Its state at the time reached; nothing may be foreseen.
    std::vector<std::uint8_t> save();
    /// Into a node that was never granted anything: it stands at `time` then. Throws InputError if the state
    /// does not fit.
    void load(Time time, std::span<const std::uint8_t> state);

  private:
    struct Work {
        std::uint64_t advances = 0;  ///< of the node
        std::uint64_t messages = 0;  ///< handed to it
        Time executed = 0;           ///< what was taken back counts, too
        std::uint64_t marks = 0, rewinds = 0;
    };

    bool goes_in_strides(std::span<const PortEcho> echoes) const;
    bool begin_sure(std::span<const Message>& inbox);
    void end_sure(std::vector<Message>& outbox);
    Advanced go_ahead(std::span<const Message> inbox, std::vector<Message>& outbox);
    Time may_reach(Time until, std::span<const Message> inbox) const;
    Time first_difference(std::span<const Message> inbox) const;
    std::vector<Message> used_before_reached() const;
    void check_same(const std::vector<Message>& before, const std::vector<Message>& now, Time differs) const;
    void take_back();
    void back_to_reached();
    void execute(Time until, std::span<const Message>& inbox);
    void run_on(Time until, std::span<const Message>& inbox);
    void take_in(std::span<const Message>& inbox);
    void execute_noting(Time until, std::span<const Message>& inbox);
    bool answers_late() const;
    void note_advance(Time from, Time to, std::size_t messages);
    void note_earliest_outputs();
    void sample_lookaheads();
    void forget_lookaheads();

    std::unique_ptr<Node> node_;
    StatefulNode* stateful_;            ///< the node, if it is one
    SampledInputs* sampling_;           ///< the node, if it is one
    const BoundedRewindable* bounded_;  ///< the node, if it is one
    Time reached_ = 0;
    Time ahead_ = 0;  ///< the node stands there
    Time mark_ = 0;   ///< of the node, while marked_
    bool marked_ = false;
    Time no_further_ = 0;        ///< what was tried up to there ended in an exception
    Time stopped_at_ = kNever;   ///< as far as a node that is bounded came last, if it was to go further
    std::vector<Message> used_;  ///< what came in since the mark
    std::vector<Message> sent_;  ///< what was sent since the mark
    // Of the grant under way.
    Reach reach_;
    Time wrong_ = kNever;               ///< the inbox is another one from there on
    std::vector<Message> sent_before_;  ///< what the node has to send again up to there
    std::vector<Message> rest_;         ///< of the inbox, while the node has left its advance()
    std::vector<Time>
        earliest_outputs_;          ///< by port, where the lookahead is not zero: before a message came in
    std::vector<Time> lookaheads_;  ///< by port, the shortest since the mark
    Work work_;
};

}  // namespace puckloop::cosim
