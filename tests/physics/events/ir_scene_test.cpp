// Light between range-and-bearing boards in a world that changes.

#include "physics/ir/ir_medium.h"
#include "physics/ir/ir_node.h"
#include "physics/world/pose_signals.h"
#include "tests/physics/events/plans.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

World pair() {
    World world = world_with_robot(2.0, 2.0);
    world.robots = {rab_robot("e1", 0.0, 0.0), rab_robot("e2", 0.5, 0.0)};
    return world;
}

/// Does light of board 0 arrive at board 1?
bool heard(IrMedium& medium) {
    medium.set_power(0, 0);
    medium.set_carrier(0, kFirmwareCarrier);
    medium.set_emitters(0, kAllEmitters);
    medium.begin_burst(0, 0.0);
    return medium.coupled(0, 1);
}

}  // namespace

TEST_CASE("a wall put between two boards shades, moved away it does not") {
    IrMedium medium(pair(), true);
    REQUIRE(heard(medium));
    const std::size_t fixed = fixed_shapes(pair()).size();
    medium.set_shape(true, fixed, box_shape(0.25, 0.0, 0.0, 0.02, 0.4, 0.2, 1.0));
    CHECK_FALSE(heard(medium));
    medium.set_shape(true, fixed, box_shape(0.25, 0.6, 0.0, 0.02, 0.4, 0.2, 1.0));
    CHECK(heard(medium));
    medium.set_shape(false, 0, box_shape(0.25, 0.0, 0.0, 0.02, 0.4, 0.2, 1.0));
    CHECK_FALSE(heard(medium));
    medium.set_shape(false, 0, box_shape(0.25, 0.0, 0.0, 0.02, 0.4, 0.0, 1.0));
    CHECK(heard(medium));
    medium.set_out(1, true);
    CHECK_FALSE(heard(medium));
    medium.set_out(1, false);
    CHECK(heard(medium));
}

TEST_CASE("the world reports shapes to the medium and of robots in the air") {
    World world = pair();
    link_up(world);
    Action add = action(Verb::Add, "new");
    add.thing.boxes.push_back({.name = "new", .x = 0.25, .length = 0.02, .width = 0.4, .height = 0.2});
    const auto node =
        node_with(world, {at(20 * kMillisecond, add), at(40 * kMillisecond, action(Verb::Lift, "e2")),
                          at(60 * kMillisecond, action(Verb::Remove, "new"))});
    const auto sent = run_node(*node, {}, 100 * kMillisecond, 10 * kMillisecond);
    const SceneSignals ids{2};
    const std::size_t walls = fixed_shapes(world).size();
    const auto box = static_cast<std::uint16_t>(ids.shape(true, walls));
    using Changes = std::vector<std::pair<Time, double>>;
    constexpr cosim::PortIndex kIr = 4;
    CHECK(changes(sent, kIr, static_cast<std::uint16_t>(ids.out(1))) == Changes{{41 * kMillisecond, 1.0}});
    CHECK(changes(sent, kIr, box) == Changes{{21 * kMillisecond, 1.0}});
    CHECK(changes(sent, kIr, static_cast<std::uint16_t>(box + 1)) == Changes{{21 * kMillisecond, 0.25}});
    CHECK(changes(sent, kIr, static_cast<std::uint16_t>(box + 6)) ==
          Changes{{21 * kMillisecond, 0.2}, {61 * kMillisecond, 0.0}});
    // And the medium's node takes them without a word.
    IrNode medium(world, {.changes = true});
    std::vector<Message> inbox, out;
    for (const auto& message : sent)
        if (message.port == kIr) inbox.push_back({message.time, 2, message.payload});
    medium.advance(100 * kMillisecond, inbox, out);
    CHECK(medium.finish().starts_with("{"));
}
