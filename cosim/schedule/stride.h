#pragma once
// Going on without asking: how a node, wherever it lives, uses a grant that reaches beyond the echo of its
// own messages.
//
// A node may be granted as far as the others, by themselves, leave it alone. Only what it sends itself can
// come back earlier; so it goes in strides, each no longer than the shortest way out and back, and stops
// before the echo of what it said. A board that is silent on all its lines thus runs for a whole step of the
// world with one round trip to the conductor.

#include "cosim/core/message.h"
#include "cosim/core/node.h"
#include "cosim/core/time.h"

#include <span>
#include <vector>

namespace puckloop::cosim {

/// What one port's messages meet on their way out and back.
struct PortEcho {
    Time flight = 0;     ///< of a UART frame, from its start bit
    Time latency = 0;    ///< of the link
    Time back = kNever;  ///< from the delivery at the far end to the first message that comes back
    bool is_uart = false;

    friend bool operator==(const PortEcho&, const PortEcho&) = default;
};

/// How far a grant reaches.
struct Reach {
    Time sure = 0;   ///< nothing comes in before, whatever the node sends
    Time until = 0;  ///< nothing but the echo of what it sends; >= sure
    Time ahead = 0;  ///< a node that can go back runs on to here (cosim/schedule/run_ahead.h); >= until

    friend bool operator==(const Reach&, const Reach&) = default;
};

/// Advances `node`, which has reached `from`, at most to `reach.until`; returns how far it went. `echoes` has
/// one entry per port, or none: then nothing can come back and reach.until is reached in one stride. Messages
/// of the inbox from the returned time on were not given to the node.
Time advance_in_strides(Node& node, Time from, Reach reach, std::span<const Message> inbox,
                        std::span<const PortEcho> echoes, std::vector<Message>& outbox);

}  // namespace puckloop::cosim
