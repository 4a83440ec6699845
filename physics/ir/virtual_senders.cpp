#include "physics/ir/virtual_senders.h"

#include "protocols/infrared/rab_frame.h"

#include <algorithm>
#include <string>

namespace puckloop::physics {

namespace {

constexpr int kBitsOfByte = 8;
// A frame drawn early or late stays within its turn, and the boards' frames do not overlap their own.
constexpr double kMostOfPeriod = 0.25;

}  // namespace

VirtualSenders::VirtualSenders(const World& world, cosim::Time chip) {
    for (const VirtualBoard& board : world.virtuals.boards) {
        std::uint32_t payload = 0;
        for (const std::uint8_t byte : board.data)
            payload = payload << kBitsOfByte | byte;
        const int size = kBitsOfByte * static_cast<int>(board.data.size());
        const std::string chips = protocols::encode_rab(size, payload) + '0';
        Sender sender{.edges = {},
                      .every = cosim::from_seconds(board.every),
                      .first = cosim::from_seconds(board.begin),
                      .deviation = board.jitter,
                      .jitter = RandomStream(world.seed, "ir/" + board.name + "/times")};
        char before = '0';
        for (std::size_t i = 0; i < chips.size(); ++i) {
            if (chips[i] != before) sender.edges.push_back(static_cast<cosim::Time>(i) * chip);
            before = chips[i];
        }
        plan(sender);
        senders_.push_back(std::move(sender));
    }
}

/// When the frame of its turn begins.
void VirtualSenders::plan(Sender& sender) {
    const double most = kMostOfPeriod * cosim::to_seconds(sender.every);
    const double late = std::clamp(sender.deviation * sender.jitter.normal(), -most, most);
    const cosim::Time exact = sender.first + static_cast<cosim::Time>(sender.turn) * sender.every;
    // Nothing begins before the run does.
    sender.begin = std::max<cosim::Time>(exact + cosim::from_seconds(late), 1);
    sender.next = sender.begin + sender.edges.front();
}

void VirtualSenders::go_on(Sender& sender) {
    if (++sender.edge < sender.edges.size()) {
        sender.next = sender.begin + sender.edges[sender.edge];
        return;
    }
    sender.edge = 0;
    ++sender.turn;
    plan(sender);
}

cosim::Time VirtualSenders::next() const {
    cosim::Time first = cosim::kNever;
    for (const Sender& sender : senders_)
        first = std::min(first, sender.next);
    return first;
}

}  // namespace puckloop::physics
