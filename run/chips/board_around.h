#pragma once
// A node around a board, which profiles it, watches it, debugs it or has a client drive it: what it does not
// do itself the board does.

#include "cosim/core/stateful_node.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::tools {

class BoardAround : public cosim::StatefulNode {
  public:
    explicit BoardAround(std::unique_ptr<cosim::StatefulNode> board) : board_(std::move(board)) {}

    cosim::StatefulNode& board() { return *board_; }

    std::string_view name() const override { return board_->name(); }
    std::span<const cosim::Port> ports() const override { return board_->ports(); }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override {
        board_->advance(until, inbox, outbox);
    }
    cosim::Time earliest_output(cosim::PortIndex port) const override {
        return board_->earliest_output(port);
    }
    cosim::Time lookahead(cosim::PortIndex port) const override { return board_->lookahead(port); }
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override { return board_->begun(port); }
    void state(StateWriter& archive) const override { std::as_const(*board_).state(archive); }
    void state(StateReader& archive) override { board_->state(archive); }
    void renew_random_streams() override { board_->renew_random_streams(); }
    std::string finish() override { return board_->finish(); }

  protected:
    /// The first part of an advance, up to `until`: what came in before is taken out of `inbox`.
    void advance_part(cosim::Time until, std::span<const cosim::Message>& inbox,
                      std::vector<cosim::Message>& outbox) {
        const auto later = std::find_if(inbox.begin(), inbox.end(),
                                        [&](const cosim::Message& message) { return message.time >= until; });
        const auto count = static_cast<std::size_t>(later - inbox.begin());
        board_->advance(until, inbox.first(count), outbox);
        inbox = inbox.subspan(count);
    }
    /// Of a board that somebody may change at any instant from `reached` on, so that it sends earlier. Only a
    /// bus's next phase waits for the answer to the last one all the same.
    cosim::Time earliest_if_changed(cosim::PortIndex port, cosim::Time reached) const {
        const cosim::Time earliest = board_->earliest_output(port);
        const bool bus = board_->ports()[port].kind == cosim::PortKind::I2c;
        return bus && earliest == cosim::kNever ? earliest : std::min(earliest, reached);
    }

  private:
    std::unique_ptr<cosim::StatefulNode> board_;
};

}  // namespace puckloop::tools
