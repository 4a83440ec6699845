#include "run/debugging/debugged_node.h"

#include "emu/avr/chip/chip.h"
#include "emu/dspic/chip/chip.h"
#include "run/chips/board_around.h"
#include "run/debugging/board_debugger.h"

#include <utility>

namespace puckloop::tools {

namespace {

class DebuggedNode final : public BoardAround {
  public:
    DebuggedNode(std::unique_ptr<cosim::StatefulNode> board, BoardDebugger& debugger)
        : BoardAround(std::move(board)), debugger_(debugger) {
        debugger_.set_board(this->board());
    }

    /// The debugger may press reset at any instant.
    cosim::Time earliest_output(cosim::PortIndex port) const override {
        return earliest_if_changed(port, reached_);
    }
    std::optional<cosim::Stop> stop() const override { return stop_; }
    using BoardAround::state;
    void state(StateReader& archive) override {
        BoardAround::state(archive);
        reached_ = debugger_.granted();
    }
    std::string finish() override {
        debugger_.look_at(nullptr);
        debugger_.on_exit(0);
        return BoardAround::finish();
    }

    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override {
        debugger_.look_at(debugger_.begin_advance(reached_, outbox));
        // What the debugger changed between two advances it changes there again.
        debugger_.repeat_changes(reached_);
        while (const auto at = debugger_.next_change(until)) {
            advance_part(*at, inbox, outbox);
            debugger_.repeat_changes(*at);
        }
        BoardAround::advance(until, inbox, outbox);
        reached_ = until;
        debugger_.end_advance(until);
        if (const auto at = debugger_.killed_at()) stop_ = cosim::Stop{*at, false, "killed by its debugger"};
    }

  private:
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
