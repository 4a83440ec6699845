#pragma once
// The chip in a board of a run, as debuggers and profiles see it.

#include "cosim/core/clock.h"
#include "cosim/core/node.h"
#include "debug/debug_chip.h"

#include <functional>
#include <memory>
#include <vector>

namespace puckloop::tools {

struct BoardChip {
    std::unique_ptr<debug::DebugChip> chip;     ///< null: the node is no board
    const cosim::ClockDomain* clock = nullptr;  ///< of the chip's cycles, in the board's own time
    std::function<cosim::Time()> granted{};     ///< the end of the node's last advance
    /// A pulse on the reset pin where the chip is now: between two advances of the node, or before an
    /// instruction (chip::Instrument). What leaves at once goes to the outbox.
    std::function<void(std::vector<cosim::Message>&)> press_reset;
};

/// Through what is around it (BoardAround). `board` must outlive it.
BoardChip chip_of(cosim::Node& board);

}  // namespace puckloop::tools
