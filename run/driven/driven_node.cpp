#include "run/driven/driven_node.h"

#include <algorithm>
#include <utility>

namespace puckloop::tools {

DrivenNode::DrivenNode(std::unique_ptr<cosim::StatefulNode> board)
    : BoardAround(std::move(board)), chip_(chip_of(this->board())) {}

cosim::Time DrivenNode::next_instruction() const {
    return std::max(reached_, chip_.clock->time_of(chip_.chip->cycle()));
}

void DrivenNode::state(StateReader& archive) {
    BoardAround::state(archive);
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
    BoardAround::advance(until, inbox, outbox);
    if (watched) chip_.chip->set_instrument(nullptr, false);
    reached_ = until;
    if (stop_wanted_) stop_ = std::exchange(stop_wanted_, std::nullopt);
}

}  // namespace puckloop::tools
