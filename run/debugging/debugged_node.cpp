#include "run/debugging/debugged_node.h"

#include "emu/avr/chip/chip.h"
#include "emu/dspic/chip/chip.h"
#include "run/debugging/board_debugger.h"

#include <algorithm>
#include <utility>

namespace puckloop::tools {

namespace {

class DebuggedNode final : public cosim::StatefulNode {
  public:
    DebuggedNode(std::unique_ptr<cosim::StatefulNode> board, BoardDebugger& debugger)
        : board_(std::move(board)), debugger_(debugger) {
        debugger_.set_board(*board_);
    }

    std::string_view name() const override { return board_->name(); }
    std::span<const cosim::Port> ports() const override { return board_->ports(); }
    /// The debugger may press reset at any instant. Only a bus's next phase waits for the answer to the last
    /// one all the same.
    cosim::Time earliest_output(cosim::PortIndex port) const override {
        const cosim::Time earliest = board_->earliest_output(port);
        const bool bus = board_->ports()[port].kind == cosim::PortKind::I2c;
        return bus && earliest == cosim::kNever ? earliest : std::min(earliest, reached_);
    }
    cosim::Time lookahead(cosim::PortIndex port) const override { return board_->lookahead(port); }
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override { return board_->begun(port); }
    std::optional<cosim::Stop> stop() const override { return stop_; }
    void state(StateWriter& archive) const override {
        const cosim::StatefulNode& board = *board_;
        board.state(archive);
    }
    void state(StateReader& archive) override {
        board_->state(archive);
        reached_ = debugger_.granted();
    }
    void renew_random_streams() override { board_->renew_random_streams(); }
    std::string finish() override {
        debugger_.look_at(nullptr);
        debugger_.on_exit(0);
        return board_->finish();
    }

    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override {
        debugger_.look_at(debugger_.begin_advance(reached_, outbox));
        // What the debugger changed between two advances it changes there again.
        debugger_.repeat_changes(reached_);
        while (const auto at = debugger_.next_change(until)) {
            const auto later = std::find_if(inbox.begin(), inbox.end(), [&](const cosim::Message& message) {
                return message.time >= *at;
            });
            const auto count = static_cast<std::size_t>(later - inbox.begin());
            board_->advance(*at, inbox.first(count), outbox);
            inbox = inbox.subspan(count);
            debugger_.repeat_changes(*at);
        }
        board_->advance(until, inbox, outbox);
        reached_ = until;
        debugger_.end_advance(until);
        if (const auto at = debugger_.killed_at()) stop_ = cosim::Stop{*at, false, "killed by its debugger"};
    }

  private:
    std::unique_ptr<cosim::StatefulNode> board_;
    BoardDebugger& debugger_;
    cosim::Time reached_ = 0;
    std::optional<cosim::Stop> stop_;
};

}  // namespace

std::unique_ptr<cosim::Node> make_debugged(std::unique_ptr<cosim::StatefulNode> board,
                                           BoardDebugger& debugger) {
    return std::make_unique<DebuggedNode>(std::move(board), debugger);
}

}  // namespace puckloop::tools
