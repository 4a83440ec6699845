// Which nodes are granted together.

#include "cosim/schedule/schedule.h"

#include <catch2/catch.hpp>

using namespace puckloop::cosim;

namespace {

constexpr std::size_t kBoard = 0, kOther = 1, kWorld = 2;

/// What comes by it is counted on.
Channel wire(std::size_t from, std::size_t to, Time base, Time lookahead) {
    Channel channel;
    channel.punctual = 1;
    channel.from = from;
    channel.to = to;
    channel.base = base;
    channel.lookahead = lookahead;
    return channel;
}

/// Two boards at the times given and a world that steps by a millisecond: having stepped to 1 ms, its next
/// values are those of 3 ms. Returns what is granted now.
std::vector<std::size_t> chosen(Time board, Time other, Schedule& schedule) {
    const Time next_values = 3 * kMillisecond;
    const std::vector<Channel> channels{
        wire(kBoard, kWorld, board, 0), wire(kWorld, kBoard, next_values, kMillisecond + 1),
        wire(kOther, kWorld, other, 0), wire(kWorld, kOther, next_values, kMillisecond + 1)};
    std::vector<NodeTimes> nodes(3);
    nodes[kBoard].granted = nodes[kBoard].ahead = board;
    nodes[kOther].granted = nodes[kOther].ahead = other;
    nodes[kBoard].runs_ahead = nodes[kOther].runs_ahead = true;
    nodes[kWorld].granted = kMillisecond;
    const std::vector<Time> pending(3, kNever);
    schedule.plan(channels, pending, nodes, {kSecond, kNever, 10 * kMillisecond});
    return schedule.chosen();
}

}  // namespace

TEST_CASE("the world steps beside boards that may go on without it") {
    Schedule schedule;
    CHECK(chosen(2 * kMillisecond, 2 * kMillisecond, schedule) ==
          std::vector<std::size_t>{kBoard, kOther, kWorld});
    CHECK(schedule.target(kWorld) == 2 * kMillisecond);
    CHECK(schedule.target(kBoard) == 3 * kMillisecond);
    // Not before all of them are where the step is.
    Schedule earlier;
    CHECK(chosen(2 * kMillisecond, 2 * kMillisecond - 1, earlier) ==
          std::vector<std::size_t>{kBoard, kOther});
    // Where the boards have nothing left to do it goes, too.
    Schedule later;
    CHECK(chosen(3 * kMillisecond, 3 * kMillisecond, later) == std::vector<std::size_t>{kWorld});
    CHECK(later.target(kWorld) == 3 * kMillisecond);
}
