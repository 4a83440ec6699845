// The medium as a node: times, EOTs, grants cut anyhow, frames as they were on the air.

#include "base/error.h"
#include "base/fields/json.h"
#include "physics/ir/ir_node.h"
#include "physics/node/world_node.h"
#include "physics/world/pose_signals.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include <filesystem>
#include <map>
#include <sstream>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::kNever;
using cosim::Message;
using cosim::PortIndex;
using cosim::Signal;
using cosim::Time;

namespace {

constexpr Time kChip = 98'090'000;

void set_up_board(std::vector<Message>& messages, PortIndex board) {
    messages.push_back({kMicrosecond, board, Signal{kCarrierId, kFirmwareCarrier}});
    messages.push_back({kMicrosecond, board, Signal{kPowerId, 115}});
}

void switch_all(std::vector<Message>& messages, Time at, PortIndex board, bool on) {
    for (std::uint16_t i = 0; i < kIrSensors; ++i)
        messages.push_back({at, board, Signal{static_cast<std::uint16_t>(kEmitter + i), on ? 1.0 : 0.0}});
}

/// One frame of 46 chips, payload 0x1234.
constexpr const char* kChips = "1111110101100110100101011001011001010110011010";
void send(std::vector<Message>& messages, Time start, PortIndex board, const std::string& chips = kChips) {
    bool on = false;
    for (std::size_t i = 0; i <= chips.size(); ++i) {
        const bool next = i < chips.size() && chips[i] == '1';
        if (next != on) switch_all(messages, start + static_cast<Time>(i) * kChip, board, next);
        on = next;
    }
}

void sort(std::vector<Message>& messages) {
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
}

/// Runs the node in grants of `slice`, checking order, EOT and lookahead of every message.
std::vector<Message> run(IrNode& node, std::vector<Message> messages, Time duration, Time slice) {
    sort(messages);
    std::vector<Message> all;
    std::map<PortIndex, Time> last;
    auto next = messages.begin();
    for (Time until = std::min(slice, duration);; until = std::min(until + slice, duration)) {
        auto end = next;
        while (end != messages.end() && end->time < until)
            ++end;
        std::vector<Time> earliest;
        for (PortIndex p = 0; p < node.ports().size(); ++p) {
            const Time caused = next == end ? kNever : cosim::later(next->time, node.lookahead(p));
            earliest.push_back(std::min(node.earliest_output(p), caused));
        }
        std::vector<Message> out;
        node.advance(until, std::vector<Message>(next, end), out);
        for (const auto& message : out) {
            REQUIRE(message.time >= earliest[message.port]);
            REQUIRE(message.time >= last[message.port]);
            last[message.port] = message.time;
        }
        all.insert(all.end(), out.begin(), out.end());
        next = end;
        if (until == duration) break;
    }
    std::stable_sort(all.begin(), all.end(), [](const Message& a, const Message& b) {
        return std::pair(a.time, a.port) < std::pair(b.time, b.port);
    });
    return all;
}

std::vector<std::string> rows(const std::filesystem::path& file) {
    std::vector<std::string> lines;
    std::istringstream text(tests::text_of(file));
    for (std::string line; std::getline(text, line);)
        lines.push_back(line);
    return lines;
}

World trio() {
    World world = rab_pair(0.2);
    world.robots.push_back(robot_at("bare", 0, 0.5));
    world.robots.push_back(rab_robot("far", -0.5, 0.3, 1.0));
    world.boxes.push_back({.name = "crate", .x = 0.5, .y = 0.5, .movable = true});
    return world;
}

/// Three boards that talk at once now and then, while "a" and the crate move.
std::vector<Message> chatter() {
    std::vector<Message> messages;
    for (PortIndex board = 0; board < 3; ++board) {
        set_up_board(messages, board);
        for (int i = 0; i < 6; ++i)
            send(messages, 10 * kMillisecond + board * 1'700'000'123LL + i * (9 + board) * kMillisecond,
                 board);
    }
    for (Time t = kMillisecond; t < 80 * kMillisecond; t += kMillisecond) {
        messages.push_back({t, 3, Signal{1, 1e-4 * cosim::to_seconds(t) * 1e3}});
        messages.push_back({t, 3, Signal{4 * 3 + 1, 0.5 - 1e-3 * cosim::to_seconds(t) * 1e3}});
    }
    return messages;
}

}  // namespace

TEST_CASE("a frame arrives chip by chip, each edge after its delay, on receivers that face it") {
    World world = rab_pair(0.2);
    make_ideal(world);
    IrNode node(world, {});
    REQUIRE(node.ports().size() == 3);
    CHECK(node.ports()[0].name == "a.ir");
    CHECK(node.ports()[2].name == "world");
    std::vector<Message> messages;
    set_up_board(messages, 0);
    send(messages, 5 * kMillisecond, 0);
    const auto out = run(node, messages, 20 * kMillisecond, 100 * kMicrosecond);
    std::string seen(46, '0');
    bool lit = false;
    std::size_t chip = 0;
    for (const auto& message : out) {
        if (message.port != 1) {
            CHECK(std::get<Signal>(message.payload).id >= kPeak);  // baseline only
            CHECK(message.time == 20 * kMicrosecond);
            continue;
        }
        const auto& signal = std::get<Signal>(message.payload);
        if (signal.id != kDemod + 6) continue;
        CHECK((message.time - 20 * kMicrosecond - 5 * kMillisecond) % kChip == 0);
        const auto at =
            static_cast<std::size_t>((message.time - 20 * kMicrosecond - 5 * kMillisecond) / kChip);
        for (; chip < at; ++chip)
            seen[chip] = lit ? '1' : '0';
        lit = signal.value != 0.0;
    }
    CHECK(seen == kChips);
    CHECK_FALSE(lit);
}

TEST_CASE("the level stands through the frame and falls once after it") {
    World world = rab_pair(0.2);
    make_ideal(world);
    IrNode node(world, {});
    std::vector<Message> messages;
    set_up_board(messages, 0);
    send(messages, 5 * kMillisecond, 0);
    std::vector<std::pair<Time, double>> levels;
    for (const auto& message : run(node, messages, 20 * kMillisecond, kMillisecond))
        if (const auto& signal = std::get<Signal>(message.payload);
            message.port == 1 && signal.id == kPeak + 6)
            levels.emplace_back(message.time, signal.value);
    REQUIRE(levels.size() == 3);
    const double dark = levels[0].second;
    CHECK(levels[1].first == 5 * kMillisecond + 20 * kMicrosecond);
    CHECK(levels[1].second > dark + 500);
    // The last chip but one is the last lit one.
    CHECK(levels[2].first == 5 * kMillisecond + 45 * kChip + 350 * kMicrosecond + 20 * kMicrosecond);
    CHECK(levels[2].second == dark);
}

TEST_CASE("what the medium sends does not depend on how time was granted, and repeats bit for bit") {
    const auto folder = puckloop::tests::scratch_path("puckloop-ir-node-test");
    std::filesystem::create_directories(folder);
    const auto file = (folder / "ir.csv").string();
    const Time duration = 100 * kMillisecond;
    std::vector<Message> first;
    std::string report;
    std::string csv;
    for (const Time slice : {duration, kMillisecond, 33'333'333L, 7 * kMicrosecond}) {
        IrNode node(from_json(to_json(trio())), {"ir", file});
        const auto out = run(node, chatter(), duration, slice);
        const auto said = node.finish();
        if (first.empty()) {
            first = out;
            report = said;
            csv = tests::text_of(file);
        }
        CHECK(out == first);
        CHECK(said == report);
        CHECK(tests::text_of(file) == csv);
    }
    CHECK(first.size() > 3000);
    std::filesystem::remove_all(folder);
}

TEST_CASE("frames on the air: who heard what, what overlapped, frames back to back") {
    const auto folder = puckloop::tests::scratch_path("puckloop-ir-frames-test");
    std::filesystem::create_directories(folder);
    const auto file = folder / "ir.csv";
    World world = rab_pair(0.2);
    world.robots.push_back(rab_robot("far", -1.6, 0));
    make_ideal(world);
    IrNode node(world, {"ir", file.string()});
    std::vector<Message> messages;
    for (PortIndex board = 0; board < 3; ++board)
        set_up_board(messages, board);
    send(messages, 5 * kMillisecond, 0);
    send(messages, 5 * kMillisecond + 47 * kChip, 0);  // one dark chip between them
    send(messages, 30 * kMillisecond, 0);
    send(messages, 32 * kMillisecond, 1);  // at the same time
    send(messages, 60 * kMillisecond, 2);  // out of reach
    run(node, messages, 80 * kMillisecond, kMillisecond);
    const auto report = node.finish();
    const auto lines = rows(file);
    REQUIRE(lines.size() == 1 + 5 * 2);
    CHECK(lines[0].rfind("t_s,end_s,sender,receiver,distance_m,", 0) == 0);
    CHECK(lines[1].rfind("0.005000,0.009414,a,b,0.2000,", 0) == 0);
    CHECK_THAT(lines[1], Catch::EndsWith(",1,,0"));
    CHECK(lines[2].rfind("0.005000,0.009414,a,far,1.5300,0,0.", 0) != 0);  // dim, but there
    CHECK_THAT(lines[2], Catch::EndsWith(",0,0,,0"));
    CHECK(lines[3].rfind("0.009610,0.014024,a,b,", 0) == 0);
    CHECK(lines[5].rfind("0.030000,0.034414,a,b,", 0) == 0);
    CHECK_THAT(lines[5], Catch::EndsWith(",1,,1"));  // b was sending itself
    CHECK(lines[7].rfind("0.032000,0.036414,b,a,", 0) == 0);
    CHECK_THAT(lines[7], Catch::EndsWith(",1,,1"));
    CHECK_THAT(lines[9], Catch::EndsWith(",0,0,,0"));
    CHECK_THAT(report,
               Catch::Contains(R"("receiver":"b","frames":4,"above_threshold":3,"below_threshold":1)"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("two senders heard at once are reported at the third") {
    const auto folder = puckloop::tests::scratch_path("puckloop-ir-overlap-test");
    std::filesystem::create_directories(folder);
    const auto file = folder / "ir.csv";
    World world = rab_pair(0.2);
    world.robots.push_back(rab_robot("c", 0.135, 0.3));
    make_ideal(world);
    IrNode node(world, {"ir", file.string()});
    std::vector<Message> messages;
    for (PortIndex board = 0; board < 3; ++board)
        set_up_board(messages, board);
    send(messages, 5 * kMillisecond, 0);
    send(messages, 9 * kMillisecond, 1);
    send(messages, 20 * kMillisecond, 1);
    run(node, messages, 80 * kMillisecond, kMillisecond);
    const auto report = node.finish();
    const auto lines = rows(file);
    REQUIRE(lines.size() == 1 + 3 * 2);
    CHECK_THAT(lines[2], Catch::Contains(",a,c,") && Catch::EndsWith(",1,b,0"));
    CHECK_THAT(lines[4], Catch::Contains(",b,c,") && Catch::EndsWith(",1,a,0"));
    CHECK_THAT(lines[6], Catch::Contains(",b,c,") && Catch::EndsWith(",1,,0"));
    CHECK_THAT(report, Catch::Contains(R"("collisions":2)"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("boards that change over at one instant make no level that never was") {
    World world = rab_pair(0.2);
    world.robots.push_back(rab_robot("c", 0.135, 0.3));
    make_ideal(world);
    IrNode node(world, {});
    std::vector<Message> messages;
    for (PortIndex board = 0; board < 3; ++board)
        set_up_board(messages, board);
    send(messages, 5 * kMillisecond, 0, "101010101010");
    send(messages, 5 * kMillisecond, 1, "010101010101");
    double highest[2] = {};
    for (const auto& message : run(node, messages, 5 * kMillisecond + 4 * kChip, kMillisecond))
        if (const auto& s = std::get<Signal>(message.payload); message.port == 2 && s.id >= kPeak)
            highest[0] = std::max(highest[0], s.value);
    IrMedium medium(world);
    for (const std::size_t sender : {0U, 1U}) {
        medium.set_power(sender, 115);
        medium.set_carrier(sender, kFirmwareCarrier);
        medium.set_emitters(sender, kAllEmitters);
        medium.begin_burst(sender, 0);
        const auto level = medium.at(2).level;
        highest[1] = std::max<double>(highest[1], *std::max_element(level.begin(), level.end()));
        medium.set_emitters(sender, 0);
    }
    CHECK(highest[0] == Approx(highest[1]).margin(1));
}

TEST_CASE("alone, a board gets its baseline and nothing can reach it") {
    World world;
    world.arena = rectangular_arena(1, 1);
    world.robots = {rab_robot("a", 0, 0)};
    IrNode node(world, {});
    CHECK(node.lookahead(0) == kNever);
    CHECK(node.lookahead(1) == kNever);
    std::vector<Message> messages;
    set_up_board(messages, 0);
    send(messages, 5 * kMillisecond, 0);
    const auto out = run(node, messages, 20 * kMillisecond, kMillisecond);
    CHECK(out.size() == kIrSensors);
    CHECK(node.earliest_output(0) == kNever);
}

TEST_CASE("boards may run ahead of each other by the shortest delay") {
    World world = rab_pair(0.2);
    CHECK(IrNode(world, {}).lookahead(0) == 20 * kMicrosecond);
    world.robots[1].parameters = {{"ir.delay_off", 5e-6}};
    CHECK(IrNode(world, {}).lookahead(1) == 5 * kMicrosecond);
    CHECK(IrNode(world, {}).lookahead(0) == 20 * kMicrosecond);
    CHECK(IrNode(world, {}).lookahead(2) == kNever);
}

TEST_CASE("a carrier that never ends follows the robots") {
    World world = rab_pair(0.2);
    make_ideal(world);
    IrNode node(world, {});
    std::vector<Message> messages;
    set_up_board(messages, 0);
    switch_all(messages, 5 * kMillisecond, 0, true);
    messages.push_back({50 * kMillisecond, 2, Signal{3, 2.0}});  // b leaves
    double demod = -1;
    Time when = 0;
    for (const auto& message : run(node, messages, 80 * kMillisecond, kMillisecond))
        if (const auto& s = std::get<Signal>(message.payload); message.port == 1 && s.id == kDemod + 6) {
            demod = s.value;
            when = message.time;
        }
    CHECK(demod == 0.0);
    CHECK(when == 50 * kMillisecond + 20 * kMicrosecond);
}

TEST_CASE("the world publishes to the medium where things are, only when a board is aboard") {
    World world = trio();
    CHECK(pose_signal_names(world)[4] == "b.y");
    CHECK(pose_signal_names(world)[12] == "crate.x");
    WorldNode node(world);
    REQUIRE(node.ports().size() == 9);
    CHECK(node.ports()[8].name == "ir");
    std::vector<Message> out;
    node.advance(kMillisecond, {}, out);
    std::map<std::uint16_t, double> poses;
    for (const auto& message : out)
        if (message.port == 8) {
            CHECK(message.time >= kMillisecond);
            const auto& signal = std::get<Signal>(message.payload);
            poses[signal.id] = signal.value;
        }
    CHECK(poses.size() == 15);
    CHECK(poses[3] == Approx(0.27).margin(2e-4));
    CHECK(poses[11] == Approx(1.0).margin(2e-4));
    CHECK(poses[12] == Approx(0.5).margin(2e-4));
    for (auto& robot : world.robots)
        robot.rab = false;
    CHECK(WorldNode(world).ports().size() == 8);
    CHECK_THROWS_AS(IrNode(world, {}), InputError);
    IrSpec spec;
    CHECK_THROWS_WITH(from_value(spec, parse_json("{}"), "ir"), "ir: has no world");
}
