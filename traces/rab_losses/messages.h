#pragma once
// What hosts said to their range-and-bearing boards, from the register traffic: frames they asked for, polls
// and the messages these fetched.

#include "traces/rab_losses/board_bus.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::tools {

struct Send {
    cosim::Time time = 0;  ///< of the write that asked for it
    /// What all emitters are to send, cut to the payload size; none if the emitters differ.
    std::optional<std::uint32_t> payload;
};

/// A read of register 0, and the message it fetched if it said 1.
struct Poll {
    cosim::Time time = 0;
    bool message = false;
    std::uint32_t payload = 0;       ///< bytes that the host read
    std::uint32_t payload_mask = 0;  ///< which these were
};

std::vector<Send> sends_of(const std::vector<RegisterAccess>& accesses);
std::vector<Poll> polls_of(const std::vector<RegisterAccess>& accesses);
/// Median time from one poll to the next, s; 0 without two.
double poll_period(const std::vector<Poll>& polls);

}  // namespace puckloop::tools
