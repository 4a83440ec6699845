// When things happen: exact times, conditions, repetition, and whatever the grants are.

#include "base/error.h"
#include "protocols/infrared/rc5.h"
#include "protocols/network/ip_packet.h"
#include "tests/physics/events/plans.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using Changes = std::vector<std::pair<Time, double>>;

namespace {

World room() {
    World world = world_with_robot(1.0, 1.0);
    world.boxes.push_back({.name = "crate", .x = 0.3, .y = 0.3, .length = 0.1, .width = 0.1});
    world.cylinders.push_back(
        {.name = "can", .x = -0.3, .y = 0.3, .radius = 0.03, .movable = true, .mass = 0.05});
    world.lamps.push_back({.name = "sun", .x = 0.2, .y = -0.2});
    world.patches.push_back(
        {.name = "mark", .shape = Patch::Shape::Disc, .x = 0.1, .y = 0.4, .radius = 0.05});
    link_up(world);
    return world;
}

Action select(int position) {
    Action result = action(Verb::Select, "e1");
    result.number = position;
    return result;
}

Action key(int number, double hold = 0.0) {
    Action result = action(Verb::Remote, "all");
    result.number = number;
    result.address = 8;
    result.hold = hold;
    return result;
}

/// A bit of everything.
std::vector<Event> busy_plan() {
    Action add = action(Verb::Add, "new");
    add.thing.boxes.push_back(
        {.name = "new", .x = 0.3, .y = -0.3, .length = 0.05, .width = 0.05, .movable = true});
    Condition near{.kind = Condition::Kind::Near, .robot = "e1", .other = "crate", .distance = 0.02};
    Condition after{.kind = Condition::Kind::After, .other = "conditional"};
    Event last = when(after, select(3), "last");
    last.delay = 7'123 * kMicrosecond;
    Event often = at(20 * kMillisecond, action(Verb::Reset, "e1"));
    often.every = 100'500 * kMicrosecond;
    often.count = 4;
    return {at(50'500 * kMicrosecond, move_to("crate", 0.12, 0.0)),
            at(60 * kMillisecond, move_to("can", -0.1, -0.3, 0.2)),
            at(100 * kMillisecond, add),
            when(near, action(Verb::Lift, "e1")),
            at(700 * kMillisecond, move_to("crate", 0.3, 0.3)),
            at(800 * kMillisecond, action(Verb::Put, "e1")),
            last,
            often,
            at(300 * kMillisecond, key(5, 0.2)),
            at(301 * kMillisecond, action(Verb::SwitchOff, "sun"))};
}

}  // namespace

TEST_CASE("what happens does not depend on how time was granted") {
    constexpr Time kDuration = 1500 * kMillisecond;
    const auto inputs = even_steps(400, 380, kDuration);
    const auto first = node_with(room(), busy_plan());
    const auto all = run_node(*first, inputs, kDuration, 7 * kMillisecond);
    for (const Time slice : {Time{333'333'333}, 100 * kMillisecond, 50'500 * kMicrosecond}) {
        const auto other = node_with(room(), busy_plan());
        CHECK(run_node(*other, inputs, kDuration, slice) == all);
        CHECK(other->finish() == first->finish());
    }
    EventPlan plan;
    plan.events = busy_plan();
    const auto carried =
        std::make_unique<WorldNode>(from_json(to_json(room())), plan_from_json(to_json(plan)), nullptr);
    CHECK(run_node(*carried, inputs, kDuration, 13 * kMillisecond) == all);
    const auto report = nlohmann::json::parse(first->finish());
    for (const auto& event : report.at("events"))
        CHECK(event.value("why", "") == "");
}

TEST_CASE("a world to which nothing happens is as one without events") {
    constexpr Time kDuration = 400 * kMillisecond;
    const auto inputs = even_steps(300, 300, kDuration);
    WorldNode plain(room());
    const auto all = run_node(plain, inputs, kDuration, 10 * kMillisecond);
    const auto late = node_with(room(), {at(800 * kMillisecond, move_to("crate", 0.1, 0.0))});
    CHECK(run_node(*late, inputs, kDuration, 10 * kMillisecond) == all);
    const auto report = nlohmann::json::parse(late->finish());
    CHECK(report.at("events").empty());
    CHECK(report.at("warnings").size() == 1);
    CHECK(nlohmann::json::parse(plain.finish()).contains("events") == false);
}

TEST_CASE("signals to the board leave at their exact time") {
    constexpr Time kDuration = 400 * kMillisecond;
    Event often = at(10'250 * kMicrosecond, action(Verb::Reset, "e1"));
    often.every = 40 * kMillisecond;
    often.count = 3;
    const auto node =
        node_with(room(), {at(0, select(2)), at(123'457 * kMicrosecond, select(11)), often,
                           at(200'003 * kMicrosecond, key(35, 0.12)), at(250 * kMillisecond, key(1))});
    const auto sent = run_node(*node, {}, kDuration, 3 * kMillisecond);
    CHECK(changes(sent, 0, kSelectorId) == Changes{{kMicrosecond, 2.0}, {123'457 * kMicrosecond, 11.0}});
    Changes presses;
    for (int i = 0; i < 3; ++i) {
        presses.emplace_back(10'250 * kMicrosecond + i * 40 * kMillisecond, 1.0);
        presses.emplace_back(11'250 * kMicrosecond + i * 40 * kMillisecond, 0.0);
    }
    CHECK(changes(sent, 0, kResetId) == presses);
    Changes waveform;  // held for more than one period: two frames with the same toggle bit
    for (const int frame : {0, 1})
        for (const auto& edge : protocols::rc5_frame(true, 8, 35))
            waveform.emplace_back((200'003 + frame * protocols::kRc5RepeatMicroseconds + edge.microseconds) *
                                      kMicrosecond,
                                  edge.high ? 1.0 : 0.0);
    CHECK(changes(sent, 0, kRemoteId) == waveform);
    const auto report = nlohmann::json::parse(node->finish());
    CHECK(report.at("events").back().at("done") == false);
    CHECK(report.at("events").back().at("why") == "the key before is held until 0.427587 s");
}

TEST_CASE("datagrams leave at their exact time for the computer that is named") {
    constexpr Time kDuration = 100 * kMillisecond;
    const auto send = [](const std::string& computer, const std::string& text, int port) {
        Action result = action(Verb::Send, computer);
        result.text = text;
        result.number = port;
        return result;
    };
    EventPlan plan;
    plan.computers = {{"manager", 0x0a0000fe}, {"robot0", 0x0a000001}};
    plan.events = {at(0, send("manager", "loss 0.5", 7701)),
                   at(20'001 * kMicrosecond, send("robot0", "x", 9)), at(50 * kMillisecond, select(3))};
    const auto sent = [&](Time slice) {
        WorldNode node(room(), plan_from_json(to_json(plan)), nullptr);
        std::vector<std::string> lines;
        REQUIRE(node.ports().back().name == "messages");
        const auto port = static_cast<cosim::PortIndex>(node.ports().size() - 1);
        CHECK(node.lookahead(port) < cosim::kNever);
        for (const Message& message : run_node(node, {}, kDuration, slice)) {
            const auto* packet = std::get_if<cosim::Packet>(&message.payload);
            CHECK((packet != nullptr) == (message.port == port));
            if (packet == nullptr) continue;
            const auto read = protocols::decode_ip(packet->octets.view());
            REQUIRE(read);
            const auto datagram = protocols::decode_udp(*read);
            REQUIRE(datagram);
            lines.push_back(std::to_string(message.time / kMicrosecond) + " " + protocols::to_text(read->to) +
                            ":" + std::to_string(datagram->to_port) + " " + datagram->data);
        }
        return lines;
    };
    const auto lines = sent(7 * kMillisecond);
    CHECK(lines == std::vector<std::string>{"1 10.0.0.254:7701 loss 0.5", "20001 10.0.0.1:9 x"});
    CHECK(sent(kDuration) == lines);
    // Who is not there, ports and texts that cannot be.
    const auto problem = [&](Action wrong) {
        EventPlan other = plan;
        other.events = {at(0, std::move(wrong))};
        try {
            check_events(other, room());
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(problem(send("nobody", "x", 1)),
               Catch::Contains("there is no 'nobody' on the network (expected manager, robot0)"));
    CHECK_THAT(problem(send("manager", "x", 65'536)), Catch::Contains("port = 65536 is out of range"));
    CHECK_THAT(problem(send("manager", "", 1)), Catch::Contains("a text of 0 octets"));
    CHECK_THAT(problem(send("manager", std::string(1001, 'x'), 1)), Catch::Contains("a text of 1001 octets"));
    plan.computers.clear();
    CHECK_THAT(problem(send("manager", "x", 1)), Catch::Contains("there is no computer on a network"));
    // Nobody waits for a world that will never send anything.
    plan.computers = {{"manager", 0x0a0000fe}};
    plan.events.clear();
    const WorldNode quiet(room(), plan, nullptr);
    const auto port = static_cast<cosim::PortIndex>(quiet.ports().size() - 1);
    CHECK(quiet.earliest_output(port) == cosim::kNever);
    CHECK(quiet.lookahead(port) == cosim::kNever);
}

TEST_CASE("conditions come true at the step at which they hold, and events follow each other") {
    World world = room();
    Condition led{.kind = Condition::Kind::Led, .robot = "e1", .other = "led0"};
    Condition dark = led;
    dark.on = false;
    Condition turns{.kind = Condition::Kind::Wheels, .robot = "e1"};
    Condition stops = turns;
    stops.on = false;
    Condition after{.kind = Condition::Kind::After, .other = "led"};
    Event follow = when(after, select(4), "follow");
    follow.delay = 5'001 * kMicrosecond;
    Event blinks = when(led, select(1), "led");
    blinks.count = 2;
    const auto node = node_with(world, {blinks, when(dark, select(2), "dark"), follow,
                                        when(turns, select(5), "turns"), when(stops, select(6), "stops")});
    std::vector<Message> inputs{
        {50'200 * kMicrosecond, 0, Signal{kLedId, 1.0}}, {60'200 * kMicrosecond, 0, Signal{kLedId, 0.0}},
        {70'000 * kMicrosecond, 0, Signal{kLedId, 1.0}}, {80'000 * kMicrosecond, 0, Signal{kLedId, 0.0}},
        {90'000 * kMicrosecond, 0, Signal{kLedId, 1.0}}, {100'500 * kMicrosecond, 0, Signal{kLeftId, 1.0}}};
    const auto sent = run_node(*node, inputs, 1500 * kMillisecond, 9 * kMillisecond);
    auto selected = changes(sent, 0, kSelectorId);
    REQUIRE(selected.size() == 6);
    const Time stopped = selected.back().first;
    selected.pop_back();
    // Seen with the step after the change, due with the next one.
    CHECK(selected == Changes{{52 * kMillisecond, 1.0},
                              {57'001 * kMicrosecond, 4.0},
                              {62 * kMillisecond, 2.0},
                              {72 * kMillisecond, 1.0},
                              {102 * kMillisecond, 5.0}});
    CHECK(stopped > 103 * kMillisecond);
}

TEST_CASE("regions, ways and neighbours") {
    constexpr Time kDuration = 3000 * kMillisecond;
    Condition enters{.kind = Condition::Kind::Enters, .robot = "e1", .at = {0.2, 0.0}, .radius = 0.1};
    Condition square = enters;
    square.radius = 0.0;
    square.length = square.width = 0.1;
    Condition travels{.kind = Condition::Kind::Travels, .robot = "e1", .distance = 0.05};
    Condition near{.kind = Condition::Kind::Near, .robot = "e1", .other = "crate", .distance = 0.05};
    Event ways = when(travels, select(3), "ways");
    ways.count = 3;
    World world = room();
    world.boxes[0].x = 0.35;
    world.boxes[0].y = 0.0;
    const auto node = node_with(world, {when(enters, select(1), "disc"), when(square, select(2), "square"),
                                        ways, when(near, select(4), "near")});
    run_node(*node, even_steps(800, 800, kDuration), kDuration, 50 * kMillisecond);
    // 800 steps a second of 0.129 m a turn: 0.103 m/s, straight ahead from the middle.
    const auto events = nlohmann::json::parse(node->finish()).at("events");
    const auto time_of = [&](const std::string& name, int which = 0) {
        for (const auto& event : events)
            if (event.at("event") == name && which-- == 0) return event.at("at_s").get<double>();
        return -1.0;
    };
    const double speed = 0.8 * 0.1288;
    CHECK(time_of("disc") == Approx(0.1 / speed).margin(0.02));
    CHECK(time_of("square") == Approx(0.15 / speed).margin(0.02));
    for (int i = 0; i < 3; ++i)
        CHECK(time_of("ways", i) == Approx(0.05 * (i + 1) / speed).margin(0.02));
    CHECK(time_of("near") == Approx((0.35 - 0.05 - 0.05 - 0.037) / speed).margin(0.05));
}

TEST_CASE("what cannot be done is refused, reported, and the run goes on") {
    Action wall = action(Verb::Add, "crate");
    wall.thing.walls.push_back({.name = "crate", .from = {0.0, 0.4}, .to = {0.3, 0.4}});
    Action box = action(Verb::Add, "boxed");
    box.thing.boxes.push_back({.name = "boxed", .x = 0.0, .y = 0.0, .length = 0.05, .width = 0.05});
    Condition never{.kind = Condition::Kind::Enters, .robot = "e1", .at = {0.4, 0.4}, .radius = 0.01};
    Action twice = move_to("crate", 1.0, 0.0);
    twice.relative = true;
    const auto node = node_with(
        room(),
        {at(1 * kMillisecond, wall), at(2 * kMillisecond, box),
         at(3 * kMillisecond, move_to("can", 0.3, 0.3)), at(4 * kMillisecond, action(Verb::Put, "e1")),
         at(5 * kMillisecond, action(Verb::Remove, "can")), at(6 * kMillisecond, move_to("can", 0, 0.2)),
         at(7 * kMillisecond, action(Verb::SwitchOn, "sun")), at(8 * kMillisecond, twice),
         when(never, select(1)), at(800 * kMillisecond, select(1))});
    run_node(*node, {}, 20 * kMillisecond, 5 * kMillisecond);
    const auto report = nlohmann::json::parse(node->finish());
    std::vector<std::string> why;
    for (const auto& event : report.at("events"))
        if (event.at("done") == false) why.push_back(event.at("why"));
    CHECK(why == std::vector<std::string>{"there already is a 'crate'", "(0 m, 0 m) is taken by 'e1'",
                                          "(0.3 m, 0.3 m) is taken by 'crate'",
                                          "'e1' has not been lifted (expected lift before, or move)",
                                          "there is no 'can' in this world", "'sun' is on already",
                                          "(1.3 m, 0.3 m) is outside the arena"});
    const auto warnings = report.at("warnings").get<std::vector<std::string>>();
    REQUIRE(warnings.size() == 9);
    CHECK(warnings[7] == "conditional (line 2) never happened: its condition never came true");
    CHECK(warnings[8] == "event at 800000000000 (line 1) never happened: 0.8 s was not reached");
}
