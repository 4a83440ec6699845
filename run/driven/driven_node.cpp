#include "run/driven/driven_node.h"

#include <algorithm>
#include <utility>

namespace puckloop::tools {

DrivenNode::DrivenNode(std::unique_ptr<cosim::StatefulNode> board)
    : board_(std::move(board)), chip_(chip_of(*board_)) {}

cosim::Time DrivenNode::earliest_output(cosim::PortIndex port) const {
    const cosim::Time earliest = board_->earliest_output(port);
    const bool bus = board_->ports()[port].kind == cosim::PortKind::I2c;
    return bus && earliest == cosim::kNever ? earliest : std::min(earliest, reached_);
}

cosim::Time DrivenNode::next_instruction() const {
    return std::max(reached_, chip_.clock->time_of(chip_.chip->cycle()));
}

void DrivenNode::state(StateWriter& archive) const {
    const cosim::StatefulNode& board = *board_;
    board.state(archive);
}

void DrivenNode::state(StateReader& archive) {
    board_->state(archive);
    reached_ = chip_.granted();
}

/// Of the board's own advance, where what it sends has somewhere to go.
bool DrivenNode::instruction(std::uint32_t, std::uint64_t) {
    for (const auto& change : std::exchange(changes_, {}))
        change(*chip_.chip);
    return true;
}

void DrivenNode::count_interrupts(bool on) {
    counts_.reset();
    if (on) counts_.emplace().from = reached_;
}

void DrivenNode::interrupt(int vector, std::uint32_t, std::uint64_t) {
    if (counts_) ++counts_->taken[vector];
}

void DrivenNode::advance(cosim::Time until, std::span<const cosim::Message> inbox,
                         std::vector<cosim::Message>& outbox) {
    const bool watched = !changes_.empty() || counts_;
    if (watched) chip_.chip->set_instrument(this, false);
    board_->advance(until, inbox, outbox);
    if (watched) chip_.chip->set_instrument(nullptr, false);
    reached_ = until;
    if (stop_wanted_) stop_ = std::exchange(stop_wanted_, std::nullopt);
}

}  // namespace puckloop::tools
