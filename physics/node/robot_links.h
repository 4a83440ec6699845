#pragma once
// The world's ends of the two links to a robot's board and to its ground sensor.

#include "cosim/core/message.h"
#include "physics/description/channels.h"
#include "physics/description/description.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace puckloop::physics {

/// No signal of that name is on the link.
inline constexpr std::uint16_t kUnusedSignal = 0xFFFF;
inline constexpr std::size_t kBoardInputs = 3;

/// Signal ids, and what was last published.
struct RobotLinks {
    std::array<std::uint16_t, 2> wheel{kUnusedSignal, kUnusedSignal};
    std::array<std::uint16_t, kBoardInputs> input{kUnusedSignal, kUnusedSignal,
                                                  kUnusedSignal};  ///< by BoardInput
    struct Output {
        std::size_t channel = 0;
        cosim::PortIndex port = 0;
        std::uint16_t id = 0;
        double last = std::nan("");       ///< as published
        double unrounded = std::nan("");  ///< what it was made of
    };
    std::vector<Output> outputs;

    /// Appends what has changed of `channels`, stamped `time`, counts rounded to `count_quantum`.
    void publish(const Channels& channels, double count_quantum, cosim::Time time,
                 std::vector<cosim::Message>& outbox);
};

/// `board` is the port of the link to its board; the ground sensor's is the next.
RobotLinks links_of(const Robot& robot, cosim::PortIndex board);

}  // namespace puckloop::physics
