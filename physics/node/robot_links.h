#pragma once
// The world's ends of the links to a robot's board, its ground sensor and its range-and-bearing board.

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
        double quantum = 0.0;             ///< 0: the channel's own
    };
    std::vector<Output> outputs;

    /// Appends what has changed of `channels`, stamped `time`, counts rounded to `count_quantum`.
    void publish(const Channels& channels, double count_quantum, cosim::Time time,
                 std::vector<cosim::Message>& outbox);
};

/// `board` is the port of the link to its board; the ground sensor's is the next.
RobotLinks links_of(const Robot& robot, cosim::PortIndex board);

/// What its range-and-bearing board hears of the world by a link: the battery. In steps of 10 mV, as all that
/// it does with it is to fail below 2.5 V, and each message keeps that board from running ahead.
bool hears_battery(const Robot& robot);
void add_battery(RobotLinks& links, const Robot& robot, cosim::PortIndex port);

}  // namespace puckloop::physics
