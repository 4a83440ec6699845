// What the world sends cameras: when, what, and that it is enough to see the world as it is.

#include "physics/camera/camera_scene.h"
#include "physics/camera/camera_signals.h"
#include "tests/physics/events/plans.h"

#include <catch2/catch.hpp>

#include <random>
#include <set>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

/// Two robots, the second with a camera; a box that can be pushed; a floor patch and a lamp.
World room() {
    World world = world_with_robot(2.0, 2.0);
    world.robots.push_back(robot_at("e2", 0.4, 0.1, 1.0));
    world.robots[1].camera = true;
    link_up(world);
    for (Robot& robot : world.robots) {
        robot.board_signals["led3"] = 77;
        robot.ground_signals["rgb1_green"] = 78;
    }
    world.boxes.push_back({.name = "crate", .x = -0.3, .y = 0.4, .movable = true});
    world.patches.push_back({.name = "dark", .x = 0.5, .y = 0.5, .grey = 0.2});
    world.lamps.push_back({.name = "sun", .x = 0.6, .y = -0.6});
    return world;
}

constexpr cosim::PortIndex kCamera = 4;  // behind the two ports of each robot

std::vector<Message> to_camera(const std::vector<Message>& sent) {
    std::vector<Message> found;
    for (const Message& message : sent)
        if (message.port == kCamera) found.push_back(message);
    return found;
}

}  // namespace

TEST_CASE("frame times are exact, and messages come just before them") {
    CHECK(camera_frame_time(0) == 0);
    CHECK(camera_frame_time(1) == 33'333'333'333);
    CHECK(camera_frame_time(90) == 3 * cosim::kSecond);
    std::mt19937_64 random(3);
    for (int i = 0; i < 2000; ++i) {
        const Time time = std::uniform_int_distribution<Time>(0, 100 * cosim::kSecond)(random);
        const Time message = next_camera_message(time);
        CHECK(message >= time);
        CHECK(message % kMillisecond == 0);
        // A frame begins within the millisecond from there on, and no other message time lies between.
        const auto frame = static_cast<std::int64_t>(message / cosim::kMillisecond * kCameraRate / 1000);
        const Time start =
            std::min(camera_frame_time(frame) >= message ? camera_frame_time(frame) : cosim::kNever,
                     camera_frame_time(frame + 1));
        CHECK(start >= message);
        CHECK(start < message + kMillisecond);
        CHECK(message - time < 35 * kMillisecond);
    }
}

TEST_CASE("ids of what cameras see do not meet, and mean what they are") {
    const World world = room();
    const CameraSignals ids(world);
    std::set<std::size_t> used;
    using Kind = CameraSignals::Kind;
    const auto check = [&](std::size_t id, Kind kind, std::size_t index, std::size_t part) {
        CHECK(used.insert(id).second);
        const auto meaning = ids.meaning(id);
        CHECK(meaning.kind == kind);
        CHECK(meaning.index == index);
        CHECK(meaning.part == part);
    };
    check(CameraSignals::kAmbient, Kind::Ambient, 0, 0);
    check(CameraSignals::kFloorGrey, Kind::FloorGrey, 0, 0);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k)
            check(ids.pose(i) + k, Kind::Pose, i, k);
        check(ids.out(i), Kind::Out, i, 0);
    }
    for (std::size_t r = 0; r < 2; ++r) {
        for (std::size_t k = 0; k < kRingLeds; ++k)
            check(ids.ring_led(r, k), Kind::RingLed, r, k);
        for (std::size_t k = 0; k < kTurretColours; ++k)
            check(ids.turret(r, k), Kind::Turret, r, k);
    }
    check(ids.lamp(0), Kind::Lamp, 0, 0);
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, CameraSignals::kMostLamps - 1})
        for (std::size_t k = 0; k < CameraSignals::kLampValues; ++k)
            check(CameraSignals::lamp_place(i) + k, Kind::LampPlace, i, k);
    for (std::size_t i = 0; i < ids.booth_lights(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            check(ids.booth_light(i, k), Kind::BoothLight, i, k);
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t k = 0; k < kShapeSignals; ++k) {
            check(ids.shape(true, i) + k, Kind::Fixed, i, k);
            check(ids.shape(false, i) + k, Kind::Added, i, k);
            check(ids.patch(i) + k, Kind::Patch, i, k);
        }
}

TEST_CASE("cameras hear of poses, LEDs and events at frame times only") {
    World world = room();
    const CameraSignals ids(world);
    Action add = action(Verb::Add, "new");
    add.thing.boxes.push_back({.name = "new", .x = 0.25, .length = 0.02, .width = 0.4, .height = 0.2});
    Action lit = action(Verb::Add, "spot");
    lit.thing.patches.push_back({.name = "spot", .x = -0.5, .y = 0.1, .grey = 0.4});
    const auto node =
        node_with(world, {at(20 * kMillisecond, add), at(40 * kMillisecond, action(Verb::Lift, "e1")),
                          at(60 * kMillisecond, action(Verb::Remove, "new")),
                          at(80 * kMillisecond, action(Verb::Remove, "dark")), at(90 * kMillisecond, lit),
                          at(95 * kMillisecond, action(Verb::Remove, "crate"))});
    const std::vector<Message> in{{5 * kMillisecond, 0, cosim::Signal{77, 1.0}},
                                  {10 * kMillisecond, 1, cosim::Signal{78, 51.0}},
                                  {50 * kMillisecond, 0, cosim::Signal{77, 0.0}}};
    const auto sent = to_camera(run_node(*node, in, 200 * kMillisecond, 10 * kMillisecond));
    REQUIRE_FALSE(sent.empty());
    CameraScene scene(world);
    for (const Message& message : sent) {
        CHECK(next_camera_message(message.time) == message.time);
        const auto& signal = std::get<cosim::Signal>(message.payload);
        scene.change(signal.id, signal.value);
    }
    using Changes = std::vector<std::pair<Time, double>>;
    const auto id = [](std::size_t number) { return static_cast<std::uint16_t>(number); };
    CHECK(changes(sent, kCamera, id(ids.ring_led(0, 3))) ==
          Changes{{33 * kMillisecond, 1.0}, {66 * kMillisecond, 0.0}});
    CHECK(changes(sent, kCamera, id(ids.turret(0, 4))) == Changes{{33 * kMillisecond, 0.2}});
    CHECK(changes(sent, kCamera, id(ids.out(0))) == Changes{{66 * kMillisecond, 1.0}});
    const std::size_t box = ids.shape(true, fixed_shapes(world).size());
    CHECK(changes(sent, kCamera, id(box + 6)) == Changes{{33 * kMillisecond, 0.2}, {66 * kMillisecond, 0.0}});
    CHECK(changes(sent, kCamera, id(ids.out(2))) == Changes{{100 * kMillisecond, 1.0}});

    // With all of that the scene is the room as it is now.
    std::vector<Body> bodies;
    scene.bodies(1, bodies);
    CHECK(bodies.size() == 4);  // the arena's walls: the robot is in the air, box and crate are gone
    REQUIRE(scene.patches().size() == 1);
    CHECK(scene.patches()[0].x == Approx(-0.5));
    CHECK(scene.patches()[0].grey == Approx(0.4));
    CHECK(scene.robot(1).x == Approx(0.4).margin(1e-4));
    CHECK(scene.robot(1).heading == Approx(1.0).margin(1e-3));
    std::vector<Glow> glows;
    scene.glows(1, glows);
    CHECK(glows.size() == 1);  // the lamp; the lifted robot's LEDs are out of sight
}

TEST_CASE("cameras see lamps that are moved, added and taken away") {
    World world = room();
    world.lamps.push_back({.name = "moon", .x = -0.4, .y = 0.5, .height = 0.1, .intensity = 0.5});
    Action move = action(Verb::Move, "sun");
    move.to = Point{0.1, -0.3};
    Action add = action(Verb::Add, "star");
    add.thing.lamps.push_back({.name = "star", .x = -0.2, .y = 0.0, .height = 0.2, .intensity = 0.25});
    const auto seen = [&](Time until) {
        const auto node = node_with(world, {at(20 * kMillisecond, move), at(50 * kMillisecond, add),
                                            at(90 * kMillisecond, action(Verb::Remove, "sun"))});
        CameraScene scene(world);
        for (const Message& message : to_camera(run_node(*node, {}, until, 10 * kMillisecond))) {
            const auto& signal = std::get<cosim::Signal>(message.payload);
            scene.change(signal.id, signal.value);
        }
        std::vector<Glow> glows;
        scene.glows(1, glows);
        return glows;
    };
    const std::vector<Glow> before = seen(20 * kMillisecond), all = seen(80 * kMillisecond),
                            end = seen(150 * kMillisecond);
    REQUIRE(before.size() >= 2);
    REQUIRE(all.size() == before.size() + 1);
    REQUIRE(end.size() == before.size());
    const auto there = [](const std::vector<Glow>& glows, const Lamp& lamp, double brightness) {
        return std::any_of(glows.begin(), glows.end(), [&](const Glow& glow) {
            return glow.x == lamp.x && glow.y == lamp.y && glow.z == lamp.height &&
                   glow.level[0] == Approx(20.0 * brightness) && glow.radius == 0.02;
        });
    };
    const Lamp moved{.name = "sun", .x = 0.1, .y = -0.3};
    CHECK(there(before, world.lamps[0], 1.0));
    CHECK(there(all, moved, 1.0));
    CHECK(there(all, world.lamps[1], 0.5));
    CHECK(there(all, add.thing.lamps[0], 0.25));
    CHECK_FALSE(there(end, moved, 1.0));
    CHECK(there(end, world.lamps[1], 0.5));
    CHECK(there(end, add.thing.lamps[0], 0.25));
}

TEST_CASE("beyond 512 lamps a camera sees none, and one more when one goes away") {
    World world = room();
    constexpr std::size_t kRoom = 2, kAdded = 5;
    while (world.lamps.size() < CameraSignals::kMostLamps - kRoom)
        world.lamps.push_back({.name = "lamp " + std::to_string(world.lamps.size()),
                               .x = -0.9 + 0.003 * static_cast<double>(world.lamps.size())});
    std::vector<Event> events;
    for (std::size_t i = 0; i < kAdded; ++i) {
        Action add = action(Verb::Add, "added " + std::to_string(i));
        add.thing.lamps.push_back({.name = add.object, .x = 0.1 * static_cast<double>(i), .y = 0.7});
        events.push_back(at(20 * kMillisecond, add));
    }
    events.push_back(at(80 * kMillisecond, action(Verb::Remove, "sun")));
    const auto added = [&](Time until) {
        const auto node = node_with(world, events);
        CameraScene scene(world);
        for (const Message& message : to_camera(run_node(*node, {}, until, 10 * kMillisecond))) {
            const auto& signal = std::get<cosim::Signal>(message.payload);
            scene.change(signal.id, signal.value);
        }
        std::vector<Glow> glows;
        scene.glows(1, glows);
        CHECK(glows.size() <= CameraSignals::kMostLamps);
        return std::ranges::count_if(glows, [](const Glow& glow) { return glow.y == 0.7; });
    };
    CHECK(added(20 * kMillisecond) == 0);
    CHECK(added(75 * kMillisecond) == kRoom);
    CHECK(added(150 * kMillisecond) == kRoom + 1);
}

TEST_CASE("beyond some 2600 things a camera sees them as they were at the start") {
    World world = room();
    constexpr std::size_t kBoxes = 2700, kRow = 60;
    constexpr double kApart = 0.03;
    world.arena = rectangular_arena(4, 4);
    for (std::size_t i = 0; i < kBoxes; ++i)
        world.boxes.push_back({.name = "box " + std::to_string(i),
                               .x = -1.9 + kApart * static_cast<double>(i % kRow),
                               .y = 0.55 + kApart * static_cast<double>(i / kRow),
                               .length = 0.01,
                               .width = 0.01,
                               .reflectivity = 0.5});
    const CameraSignals signals(world);
    std::size_t beyond = 0;
    while (signals.shape(true, beyond) + kShapeSignals <= CameraSignals::kFirstLampPlace)
        ++beyond;
    CHECK((beyond > 2500 && beyond < kBoxes));
    std::vector<Event> events;
    for (const std::size_t box : {std::size_t{0}, kBoxes - 1}) {
        Action set = action(Verb::Set, "box " + std::to_string(box));
        set.property = "reflectivity";
        set.value = 0.9;
        events.push_back(at(20 * kMillisecond, set));
    }
    const auto node = node_with(world, events);
    CameraScene scene(world);
    for (const Message& message : to_camera(run_node(*node, {}, 75 * kMillisecond, 10 * kMillisecond))) {
        const auto& signal = std::get<cosim::Signal>(message.payload);
        scene.change(signal.id, signal.value);
    }
    std::vector<Body> bodies;
    scene.bodies(1, bodies);
    CHECK(bodies.size() > kBoxes);  // all are drawn
    const auto bright = std::ranges::count_if(
        bodies, [](const Body& body) { return body.shape.reflectivity == Approx(0.9); });
    CHECK(bright == 1);
}

TEST_CASE("a world without cameras has no port for them") {
    World world = room();
    world.robots[1].camera = false;
    const auto node = node_with(world, {});
    CHECK(node->ports().size() == 4);
    CHECK(to_camera(run_node(*node, {}, 200 * kMillisecond, 10 * kMillisecond)).empty());
}
