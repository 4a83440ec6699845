#pragma once
// A board that need not live through the beginning of a run: until the time of its saved state it sends what
// the saved board sent, without executing anything, and compares what it receives with what the saved board
// received; then it takes the state over and goes on. All others run as ever, so the run's trace is the same
// as if the board had been powered up.
//
// If it receives something else, or nothing where the saved board received something,
//   - with `fall_back` it executes from power-up what came in so far and goes on normally: the trace is right
//     in any case, only time is lost;
//   - without, the state stands: the board is as the saved one was, and the report states where they differ.
//
// It can also be the one that saves: at `save_at` it hands out its state with all that it received and sent.

#include "cosim/core/stateful_node.h"
#include "cosim/core/work_counts.h"
#include "cosim/resume/board_state.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace puckloop::cosim {

struct ResumeOptions {
    BoardIdentity board;              ///< whose states this node saves
    std::optional<BoardState> from;   ///< start from this
    std::string source;               ///< for the report: "cache", "file"
    bool fall_back = true;            ///< if what comes in differs
    bool new_random_streams = false;  ///< not the saved board's
    Time save_at = 0;                 ///< 0: nothing is saved
    /// Called once, when `save_at` is reached, but not if that is where the state of a cache was taken over.
    /// Returns a warning for the report, or nothing; it may throw RunError.
    std::function<std::string(BoardState state)> save{};
};

class ResumedNode : public Node, public CountsWork {
  public:
    /// Makes a fresh node at power-up.
    using Make = std::function<std::unique_ptr<StatefulNode>()>;

    ResumedNode(Make make, ResumeOptions options);

    std::string_view name() const override { return inner_->name(); }
    std::span<const Port> ports() const override { return inner_->ports(); }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override;
    Time earliest_output(PortIndex port) const override;
    Time lookahead(PortIndex port) const override;
    std::optional<Time> begun(PortIndex port) const override;
    std::optional<Stop> stop() const override;
    /// None while it replays or records.
    Rewindable* rewindable() override { return replaying_ || recording_ ? nullptr : inner_->rewindable(); }
    /// The board itself; at power-up until its saved state's time has come.
    StatefulNode& board() { return *inner_; }
    Time lives_from() const { return options_.from ? options_.from->time : 0; }
    /// The board's report, with "resumed" (from, at_s, skipped, what differed) added.
    std::string finish() override;
    /// The board's, if it counts.
    void add_work(WorkCounts& counts) const override {
        if (const auto* counting = dynamic_cast<const CountsWork*>(inner_.get())) counting->add_work(counts);
    }

  private:
    void replay(Time until, std::span<const Message> inbox, std::vector<Message>& outbox);
    void compare(Time until, std::span<const Message> inbox);
    void note_difference(Time time, PortIndex port, const std::string& what);
    void send_before(Time until, std::vector<Message>& outbox);
    bool take_over(std::vector<Message>& outbox);
    void execute_until_now(std::vector<Message>& outbox);
    void live(Time until, std::span<const Message> inbox, std::vector<Message>& outbox);
    void hand_out_state();
    const Message* next_sent(PortIndex port) const;
    void index_sent();

    Make make_;
    ResumeOptions options_;
    std::unique_ptr<StatefulNode> inner_;
    Time granted_ = 0;

    // While the saved board's life is replayed.
    bool replaying_ = false;
    std::size_t next_received_ = 0;
    std::size_t next_sent_ = 0;
    std::vector<std::size_t> after_;  ///< for each message sent: the next one on its port
    std::vector<std::size_t> next_on_port_;
    std::string difference_;  ///< the first; empty: none

    std::string warning_;

    // For the state to be saved.
    bool recording_ = false;
    std::vector<Message> received_;
    std::vector<Message> sent_;
};

}  // namespace puckloop::cosim
