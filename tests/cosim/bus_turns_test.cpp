// How far the nodes of one I2C bus may go in turns.

#include "cosim/schedule/bus_turns.h"

#include "base/random.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

Channel wire(std::size_t from, std::size_t to, Time base, Time lookahead, bool takes_turns = true) {
    Channel channel;
    channel.from = from;
    channel.to = to;
    channel.base = base;
    channel.lookahead = lookahead;
    channel.takes_turns = takes_turns;
    return channel;
}

/// Master 0, bus 1, device 2; the bus answers after 10 and hands on after 5, the device takes 75.
std::vector<Channel> one_bus(Time master, Time bus, Time device) {
    return {wire(0, 1, master, 0), wire(1, 0, bus, 10), wire(1, 2, bus, 5), wire(2, 1, device, 75)};
}

}  // namespace

TEST_CASE("each of a bus goes as far as the phase under way allows") {
    BusTurns turns;
    // The master sleeps until 1000: nobody sends anything before.
    auto channels = one_bus(1000, kNever, kNever);
    turns.update(channels, 4);
    REQUIRE(turns.count() == 1);
    CHECK(turns.group_of(3) == kNobody);
    CHECK(turns.limit(3) == kNever);
    turns.compute(0, channels, {kNever, kNever, kNever, kNever});
    CHECK(turns.limit(1) == 1000);
    CHECK(turns.limit(2) == 1005);
    CHECK(turns.limit(0) == 1010);
    CHECK(turns.next_send(0) == 1000);
    // The device has a phase of 300 to execute: it may, until the next one at the earliest.
    channels = one_bus(kNever, kNever, kNever);
    turns.compute(0, channels, {kNever, kNever, 300, kNever});
    CHECK(turns.limit(1) == 375);
    CHECK(turns.limit(0) == 385);
    CHECK(turns.limit(2) == 380);  // the bus may hand on at once what the device sends
    // It has, and answers at 380.
    channels = one_bus(kNever, kNever, 380);
    turns.compute(0, channels, {kNever, 380, kNever, kNever});
    CHECK(turns.limit(0) == 390);
    CHECK(turns.limit(2) == 385);
}

TEST_CASE("buses are found by the wires that are used, in whatever order") {
    RandomStream random(3, "chat");
    for (int round = 0; round < 50; ++round) {
        // Three buses of three nodes each, and a wire between two of them that carries nothing.
        std::vector<Channel> channels;
        for (std::size_t bus = 0; bus < 3; ++bus)
            for (Channel channel : one_bus(kNever, kNever, kNever)) {
                channel.from += 3 * bus;
                channel.to += 3 * bus;
                channels.push_back(channel);
            }
        channels.push_back(wire(0, 4, kNever, 0, false));
        for (std::size_t i = channels.size(); i > 1; --i)
            std::swap(channels[i - 1], channels[random.below(i)]);
        BusTurns turns;
        turns.update(channels, 9);
        for (std::size_t n = 0; n < 9; ++n) {
            CHECK(turns.group_of(n) == turns.group_of(n - n % 3));
            const auto& nodes = turns.nodes(turns.group_of(n));
            CHECK(nodes.size() == 3);
            CHECK(std::count(nodes.begin(), nodes.end(), n) == 1);
        }
        CHECK(turns.group_of(0) != turns.group_of(3));
        CHECK(turns.group_of(3) != turns.group_of(6));
        // Once it is used they are one.
        for (Channel& channel : channels)
            channel.takes_turns = true;
        turns.update(channels, 9);
        CHECK(turns.group_of(0) == turns.group_of(5));
        CHECK(turns.nodes(turns.group_of(0)).size() == 6);
    }
}
