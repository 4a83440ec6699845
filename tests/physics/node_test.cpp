// The world as a node: times, grants cut anyhow, determinism, recordings.

#include "base/error.h"
#include "physics/node/world_node.h"
#include "physics/world/world_log.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Signal;
using cosim::Time;

namespace {

constexpr std::uint16_t kLeft = 42, kRight = 43;

World busy_world() {
    World world = world_with_robot(0.6, 0.6);
    world.robots.push_back(robot_at("e2", 0.15, 0.1, 2.0));
    world.lamps.push_back({.name = "lamp", .x = 0.2, .y = -0.2});
    world.boxes.push_back({.name = "crate", .x = -0.15, .length = 0.05, .width = 0.05, .movable = true});
    for (auto& robot : world.robots) {
        for (std::size_t i = 0; i < kGroundChannel; ++i)
            robot.board_signals[std::string(channel_name(i))] = static_cast<std::uint16_t>(i);
        robot.board_signals["wheel_left"] = kLeft;
        robot.board_signals["wheel_right"] = kRight;
        for (std::size_t i = 0; i < 6; ++i)
            robot.ground_signals[std::string(channel_name(kGroundChannel + i))] =
                static_cast<std::uint16_t>(i);
    }
    return world;
}

/// Steps of two robots: one drives into the crate and the wall, one circles.
std::vector<Message> steps_for(Time duration) {
    std::vector<Message> messages;
    double counts[4]{};
    const Time periods[4] = {1'700'000'000, 1'750'000'000, 1'300'000'000, 3'100'000'000};
    const double signs[4] = {-1, -1, 1, 1};
    for (std::size_t i = 0; i < 4; ++i)
        for (Time t = periods[i]; t < duration; t += periods[i])
            messages.push_back({t, static_cast<cosim::PortIndex>(i / 2 * 2),
                                Signal{i % 2 == 0 ? kLeft : kRight, counts[i] += signs[i]}});
    std::sort(messages.begin(), messages.end(), [](const Message& a, const Message& b) {
        return std::pair(a.time, a.port) < std::pair(b.time, b.port);
    });
    return messages;
}

/// Runs the node with grants of `slice` picoseconds, checking every EOT.
std::vector<Message> run(WorldNode& node, Time duration, Time slice) {
    const auto messages = steps_for(duration);
    std::vector<Message> all;
    auto next = messages.begin();
    for (Time until = slice;; until += slice) {
        until = std::min(until, duration);
        auto end = next;
        while (end != messages.end() && end->time < until)
            ++end;
        const Time earliest = node.earliest_output(0);
        std::vector<Message> out;
        node.advance(until, std::vector<Message>(next, end), out);
        for (const auto& message : out)
            REQUIRE(message.time >= earliest);
        REQUIRE(node.earliest_output(0) > until);
        all.insert(all.end(), out.begin(), out.end());
        next = end;
        if (until == duration) return all;
    }
}

struct TemporaryDirectory {
    std::filesystem::path path = puckloop::tests::scratch_path("puckloop-physics-node-test");
    TemporaryDirectory() { std::filesystem::create_directories(path); }
    ~TemporaryDirectory() { std::filesystem::remove_all(path); }
};

}  // namespace

TEST_CASE("the node's messages do not depend on how time was granted, and repeat bit for bit") {
    constexpr Time kDuration = 3000 * kMillisecond;
    WorldNode first(busy_world()), second(busy_world()), third(busy_world()),
        json_one(from_json(to_json(busy_world())));
    const auto a = run(first, kDuration, 7 * kMillisecond);
    CHECK(a.size() > 2000);
    CHECK(run(second, kDuration, 7 * kMillisecond) == a);
    CHECK(run(third, kDuration, 333'333'333) == a);
    CHECK(run(json_one, kDuration, 100 * kMillisecond) == a);
    CHECK(first.finish() == second.finish());
}

TEST_CASE("the report has where disturbances took a robot, and none where there are none") {
    World world = busy_world();
    WorldNode left_alone(world);
    run(left_alone, 1000 * kMillisecond, 100 * kMillisecond);
    CHECK_THAT(left_alone.finish(), !Catch::Contains("push"));
    world.parameters["push.rate"] = 1.0;
    WorldNode pushed(world);
    run(pushed, 8000 * kMillisecond, 100 * kMillisecond);
    CHECK_THAT(pushed.finish(), Catch::Contains("\"pushes\":") && Catch::Contains("\"pushed_x_m\":"));
}

TEST_CASE("a step is used in the step after it and seen one later") {
    WorldNode node(busy_world());
    std::vector<Message> out;
    node.advance(0, {}, out);
    REQUIRE_FALSE(out.empty());
    for (const auto& message : out)
        CHECK(message.time == kMillisecond);
    CHECK(node.earliest_output(0) == 2 * kMillisecond);
    CHECK(node.lookahead(0) > kMillisecond);
    CHECK(node.ports()[1].name == "e1.ground");
    CHECK(node.ports()[2].name == "e2.board");
    out.clear();
    node.advance(5 * kMillisecond, {}, out);
    for (const auto& message : out) {
        CHECK(message.time >= 2 * kMillisecond);
        CHECK(message.time <= 6 * kMillisecond);
    }
}

TEST_CASE("the log has what stands where, contacts and poses, however time was granted") {
    const TemporaryDirectory directory;
    World world = busy_world();
    world.recording.log = (directory.path / "world.log").string();
    std::string log;
    for (const Time slice : {7 * kMillisecond, Time{333'333'333}, 4000 * kMillisecond}) {
        {
            WorldNode node(world);
            run(node, 4000 * kMillisecond, slice);
            node.finish();
        }
        const auto text = tests::text_of(directory.path / "world.log");
        CHECK((log.empty() || text == log));
        log = text;
    }
    for (const char* line : {
             "[    0.000000 s] arena with walls, corners (-0.3000, -0.3000) m",
             "[    0.000000 s] box crate at (-0.1500, 0.0000) m, heading 0.00 deg, 0.05 x 0.05 x 0.1 m, "
             "movable",
             "[    0.000000 s] lamp lamp at (0.2000, -0.2000) m",
             "[    0.000000 s] robot e2 at (0.1500, 0.1000) m",
             " s] e1 touches crate\n",
             "[    4.000000 s] e1 touched crate for ",
             "[    4.000000 s] e2 ends at (",
             "[    4.000000 s] crate ends at (-0.",
             "[    4.000000 s] end: 4000 steps of 1 ms, ",
         })
        CHECK_THAT(log, Catch::Contains(line));
}

TEST_CASE("contacts begin and end once, though bodies bounce") {
    const TemporaryDirectory directory;
    World world = world_with_robot(0.2, 0.6);
    world.recording.log = (directory.path / "world.log").string();
    WorldModel model(world);
    WorldLog log(model);
    Driver driver(model);
    const auto drive = [&](double speed, double seconds) {
        for (int i = 0; i < std::lround(seconds * 1e3); ++i) {
            driver.feed(speed, speed);
            model.step();
            log.after_step(model);
        }
    };
    drive(500, 1.5);
    drive(-300, 0.6);
    log.end(model);
    const auto text = tests::text_of(directory.path / "world.log");
    const auto touches = text.find(" s] e1 touches arena wall 1\n");
    INFO(text);
    REQUIRE(touches != std::string::npos);
    CHECK(text.find("e1 touches", touches + 10) == std::string::npos);
    CHECK(text.find("e1 has left arena wall 1: touched it for ") > touches);
    CHECK_THAT(text, Catch::Contains("left, ") && !Catch::Contains("e1 touched"));
}

TEST_CASE("recordings: rows at the period, readable at any time, refused directories named") {
    const TemporaryDirectory directory;
    World world = busy_world();
    world.recording = {directory.path.string(), 0.1};
    WorldNode node(world);
    run(node, 1000 * kMillisecond, 10 * kMillisecond);
    const auto trajectory = tests::text_of(directory.path / "trajectory.csv");  // not finished yet
    CHECK(std::count(trajectory.begin(), trajectory.end(), '\n') == 1 + 11 * 2);
    CHECK(trajectory.rfind("t_s,robot,x_m,y_m,theta_rad\n0.000,e1,0.000000,0.000000,0.000000\n", 0) == 0);
    CHECK(trajectory.find("\n1.000,e2,") != std::string::npos);
    const auto sensors = tests::text_of(directory.path / "sensors.csv");
    CHECK(sensors.rfind("t_s,robot,proximity0,", 0) == 0);
    CHECK(std::count(sensors.begin(), sensors.end(), '\n') == 1 + 11 * 2);
    CHECK(tests::text_of(directory.path / "objects.csv").find("crate") != std::string::npos);
    world.recording.directory = (directory.path / "absent").string();
    CHECK_THROWS_AS(WorldNode(world), RunError);
    if (std::filesystem::exists("/dev/full")) {
        std::filesystem::create_directories(directory.path / "full");
        std::filesystem::create_symlink("/dev/full", directory.path / "full" / "trajectory.csv");
        world.recording.directory = (directory.path / "full").string();
        CHECK_THROWS_WITH(WorldNode(world), Catch::Contains("trajectory.csv") && Catch::Contains("space"));
    }
}

TEST_CASE(
    "a range-and-bearing board hears of the battery in steps of 10 mV, other boards of every millivolt") {
    World world = busy_world();
    constexpr std::uint16_t kBattery = 51;
    world.robots[1].rab = true;
    world.robots[1].rab_signals["battery_v"] = kBattery;
    WorldNode node(world);
    const auto named = [&](const std::string& name) {
        const auto ports = node.ports();
        const auto found = std::find_if(ports.begin(), ports.end(),
                                        [&](const cosim::Port& port) { return port.name == name; });
        REQUIRE(found != ports.end());
        return static_cast<cosim::PortIndex>(found - ports.begin());
    };
    const cosim::PortIndex board = named("e2.board"), rab = named("e2.rab");
    for (const cosim::Port& port : node.ports())
        CHECK(port.name != "e1.rab");
    std::vector<Message> sent;
    node.advance(4 * cosim::kSecond, steps_for(4 * cosim::kSecond), sent);
    double exact = 0.0, coarse = 0.0;
    int changes = 0;
    Time last = 0;
    const auto agree = [&] {
        if (last > 0) CHECK(coarse == Approx(std::round(exact * 100) / 100).margin(0.0101));
    };
    for (const Message& message : sent) {
        const auto* signal = std::get_if<Signal>(&message.payload);
        if (signal == nullptr) continue;
        if (message.time != last) agree();
        last = message.time;
        if (message.port == board && signal->id == kBatteryVoltageChannel) exact = signal->value;
        if (message.port != rab) continue;
        CHECK(signal->id == kBattery);
        CHECK(signal->value != coarse);
        CHECK(std::abs(signal->value * 100 - std::round(signal->value * 100)) < 1e-6);
        coarse = signal->value;
        ++changes;
    }
    agree();
    CHECK(changes >= 2);  // the first one, and the motors' load
    CHECK(changes < 100);
}
