// The medium as a node: when light comes, how much, who is near; the booth's comparator.

#include "base/random.h"
#include "physics/ircom/ircom_node.h"
#include "physics/ircom/scene.h"
#include "physics/world/pose_signals.h"
#include "protocols/infrared/ircom.h"
#include "tests/ircom/worlds.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

using namespace puckloop;
using namespace puckloop::ircom_test;
using namespace puckloop::physics;

namespace {

std::vector<Message> advance(IrcomNode& node, Time until, const std::vector<Message>& inbox = {}) {
    std::vector<Message> out;
    node.advance(until, inbox, out);
    return out;
}

/// All four lines.
std::vector<Message> pulses(Time at, PortIndex robot, bool on) {
    std::vector<Message> messages;
    for (const auto id : kIds.pulse)
        messages.push_back({at, robot, Signal{id, on ? 1.0 : 0.0}});
    return messages;
}

/// A word of all lines, from `start` on.
std::vector<Message> word(Time start, PortIndex robot, std::uint8_t value) {
    std::vector<Message> messages;
    for (const auto& edge : protocols::ircom_edges(protocols::ircom_symbols(value), protocols::kIrcomEpuck))
        for (const Message& message : pulses(start + edge.time, robot, edge.lit))
            messages.push_back(message);
    return messages;
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

}  // namespace

TEST_CASE("light comes after the delay, to the picosecond, with the optics' counts, and goes again") {
    RandomStream random(31, "medium");
    for (int i = 0; i < 20; ++i) {
        const double distance = 0.08 + 0.1 * random.uniform();
        auto description = world();
        add_robot(description, "a", 0, 0, 7 * random.uniform());
        add_robot(description, "b", distance, 0, 7 * random.uniform());
        IrcomNode node(description, {"ircom", kIds, "", false});
        const Time on = 1 + static_cast<Time>(random.below(1'000'000'000));
        const Time off = on + 1 + static_cast<Time>(random.below(1'000'000'000));
        auto inbox = pulses(on, 0, true);
        for (const Message& message : pulses(off, 0, false))
            inbox.push_back(message);
        const auto out = advance(node, 3 * cosim::kMillisecond, inbox);

        const Parameters p;
        const auto parts = ircom_parts(p.proximity);
        const Robot &a = description.robots[0], &b = description.robots[1];
        std::size_t next = 0, lit = 0;
        for (const bool light : {true, false})
            for (std::size_t k = 0; k < parts.size(); ++k) {
                double expected = 0.0;
                for (const IrcomPart& part : parts) {
                    const double counts = ircom_counts(
                        in_world(part, a.x, a.y, std::cos(a.heading), std::sin(a.heading)),
                        in_world(parts[k], b.x, b.y, std::cos(b.heading), std::sin(b.heading)), p.ircom);
                    if (counts >= 0.25) expected += counts;
                }
                if (expected == 0.0) continue;
                ++lit;
                REQUIRE(next < out.size());
                const auto& signal = std::get<Signal>(out[next].payload);
                CHECK(out[next].time == (light ? on : off) + kDelay);
                CHECK(out[next].port == 1);
                CHECK(signal.id == kIds.light[k]);
                CHECK(signal.value == Approx(light ? expected : 0.0));
                ++next;
            }
        CHECK(next == out.size());
        CHECK(lit > 1);
        // As often as grants are cut, the same comes.
        IrcomNode cut(description, {"ircom", kIds, "", false});
        std::vector<Message> pieces;
        Time now = 0;
        for (std::size_t used = 0; now < 3 * cosim::kMillisecond;) {
            Time until = std::min<Time>(3 * cosim::kMillisecond,
                                        now + 1 + static_cast<Time>(random.below(90'000'000)));
            std::vector<Message> due;
            for (; used < inbox.size() && inbox[used].time < until; ++used)
                due.push_back(inbox[used]);
            for (PortIndex port = 0; port < 2; ++port)
                until = std::min(until, std::max(now + 1, cut.earliest_output(port)));
            while (!due.empty() && due.back().time >= until) {
                due.pop_back();
                --used;
            }
            cut.advance(until, due, pieces);
            now = until;
        }
        CHECK(pieces == out);
    }
}

TEST_CASE("a wall, and a robot, between two robots keep them apart") {
    for (const bool blocked : {false, true}) {
        auto description = world();
        add_robot(description, "a", 0, 0, 0);
        add_robot(description, "b", 0.2, 0, std::numbers::pi);
        if (blocked) {
            Wall wall;
            wall.name = "wall";
            wall.from = {0.1, -0.2};
            wall.to = {0.1, 0.2};
            description.walls.push_back(wall);
        }
        IrcomNode node(description, {"ircom", kIds, "", false});
        CHECK(advance(node, cosim::kMillisecond, pulses(100, 0, true)).empty() == blocked);
    }
    auto description = world();
    add_robot(description, "a", -0.15, 0, 0);
    add_robot(description, "b", 0.15, 0, std::numbers::pi);
    add_robot(description, "c", 0.0, 0, 1);
    IrcomNode node(description, {"ircom", kIds, "", false});
    for (const Message& message : advance(node, cosim::kMillisecond, pulses(100, 0, true)))
        CHECK(message.port == 2);
}

TEST_CASE("who is far from all others may run a millisecond ahead, and sees light when it has come near") {
    auto description = world(4.0);
    add_robot(description, "a", 0, 0, 0);
    add_robot(description, "b", 1.5, 0, std::numbers::pi);
    add_robot(description, "c", 0.2, 0, std::numbers::pi);
    IrcomNode node(description, {"ircom", kIds, "", false});
    CHECK(node.lookahead(0) == kDelay);
    CHECK(node.lookahead(1) == kIrcomPoseDelay);
    CHECK(node.lookahead(2) == kDelay);
    CHECK(node.earliest_output(1) == cosim::kNever);
    auto inbox = pulses(1000, 0, true);
    const Time jump = 5 * cosim::kMillisecond;
    inbox.push_back({jump, 3, Signal{3, -0.1}});  // b.x
    inbox.push_back({jump, 3, Signal{5, 0.0}});   // b.heading: b looks at a's back
    const auto out = advance(node, jump + 1, inbox);
    for (const Message& message : out)
        CHECK(message.port == 2);
    CHECK(node.lookahead(1) == kDelay);
    CHECK(node.earliest_output(1) == jump + kIrcomPoseDelay + kDelay);
    const auto later = advance(node, jump + 2 * cosim::kMillisecond);
    REQUIRE_FALSE(later.empty());
    CHECK(later.front().time == jump + kIrcomPoseDelay + kDelay);
    CHECK(later.front().port == 1);
    // Away again: its light goes with the pose.
    const Time away = 10 * cosim::kMillisecond;
    CHECK(advance(node, away + kIrcomPoseDelay, {{away, 3, Signal{3, 1.5}}}).empty());
    // Handed out as soon as it is settled, a delay before it is due.
    const auto gone = advance(node, away + kIrcomPoseDelay + 1);
    REQUIRE(gone.size() == later.size());
    CHECK(gone.front().time == away + kIrcomPoseDelay + kDelay);
    for (const Message& message : gone)
        CHECK(std::get<Signal>(message.payload).value == 0.0);
    CHECK(node.lookahead(1) == kIrcomPoseDelay);
}

TEST_CASE("the booth's comparator switches where its input crosses the threshold") {
    RandomStream random(33, "comparator");
    for (int i = 0; i < 20; ++i) {
        auto description = world();
        const double heading = 7 * random.uniform();
        add_robot(description, "robot", 0.5, 0.5,
                  heading + std::numbers::pi + 0.4 * (random.uniform() - 0.5));
        add_booth(description, "booth", 0.5, 0.5, heading);
        IrcomNode node(description, {"ircom", kIds, "", false});
        const Time on = 777'000'000, off = on + 260 * cosim::kMicrosecond;
        auto inbox = pulses(on, 0, true);
        for (const Message& message : pulses(off, 0, false))
            inbox.push_back(message);
        const auto out = advance(node, 3 * cosim::kMillisecond, inbox);
        REQUIRE(out.size() == 2);
        // Ways of a first-order low pass: up to the threshold from 0, down to it from (nearly) the light.
        const IrcomScene scene(description, false);
        double light = 0.0;
        for (std::size_t line = 0; line < kIrcomLines; ++line)
            for (const IrcomShare& share : scene.light_of(0, line))
                light += share.counts;
        const IrcomParameters p = Parameters().ircom;
        REQUIRE(light > p.tam_threshold);
        const double rise = p.tam_time * std::log(light / (light - p.tam_threshold));
        const double top = light * (1 - std::exp(-260e-6 / p.tam_time));
        const double fall = p.tam_time * std::log(top / p.tam_threshold);
        CHECK(out[0] == Message{out[0].time, 1, Signal{kIds.sense, 1.0}});
        CHECK(out[1] == Message{out[1].time, 1, Signal{kIds.sense, 0.0}});
        CHECK(cosim::to_seconds(out[0].time - on - kDelay) == Approx(rise).epsilon(1e-6));
        CHECK(cosim::to_seconds(out[1].time - off - kDelay) == Approx(fall).epsilon(1e-6));
        // And the booth's light is seen at the robot's side that looks at it.
        const auto back =
            advance(node, 5 * cosim::kMillisecond, {{4 * cosim::kMillisecond, 1, Signal{kIds.emit, 1.0}}});
        REQUIRE_FALSE(back.empty());
        for (const Message& message : back)
            CHECK(message.port == 0);
    }
}

TEST_CASE("a light too weak for the comparator, or too short, does not switch it") {
    auto description = world();
    add_robot(description, "robot", 0, 0, std::numbers::pi);
    add_booth(description, "booth", 0, 0, 0);
    IrcomNode node(description, {"ircom", kIds, "", false});
    auto glitch = pulses(1'000'000, 0, true);
    for (const Message& message : pulses(1'300'000, 0, false))  // 0.3 us
        glitch.push_back(message);
    CHECK(advance(node, cosim::kMillisecond, glitch).empty());
    description.parameters["ircom.power"] = 0.01;
    IrcomNode weak(description, {"ircom", kIds, "", false});
    CHECK(advance(weak, cosim::kMillisecond, pulses(1'000'000, 0, true)).empty());
}

TEST_CASE("words that were sent are written down, with who could see them and what overlapped") {
    const auto file = puckloop::tests::scratch_path("ircom.csv");
    auto description = world(4.0);
    add_robot(description, "a", 0, 0, 0);
    add_robot(description, "b", 0.12, 0, std::numbers::pi);
    add_robot(description, "far", -1.5, 0, 0);
    IrcomNode node(description, {"ircom", kIds, file.string(), false});
    std::vector<Message> inbox = word(cosim::kMillisecond, 0, 0x3C);
    for (const Message& message : word(60 * cosim::kMillisecond, 2, 0x81))
        inbox.push_back(message);
    for (const Message& message : pulses(100 * cosim::kMillisecond, 1, true))
        inbox.push_back(message);
    for (const Message& message : pulses(100 * cosim::kMillisecond + 285'000'000, 1, false))
        inbox.push_back(message);
    // Two at once.
    for (const Message& message : word(120 * cosim::kMillisecond, 0, 0x11))
        inbox.push_back(message);
    for (const Message& message : word(125 * cosim::kMillisecond, 1, 0x22))
        inbox.push_back(message);
    std::stable_sort(inbox.begin(), inbox.end(),
                     [](const Message& x, const Message& y) { return x.time < y.time; });
    advance(node, cosim::kSecond, inbox);
    CHECK(node.finish() == R"({"devices":[{"device":"a","words":2,"unreadable_words":0,"flashes":0},)"
                           R"({"device":"b","words":1,"unreadable_words":0,"flashes":1},)"
                           R"({"device":"far","words":1,"unreadable_words":0,"flashes":0}]})");
    const auto lines = lines_of(file);
    REQUIRE(lines.size() == 5);
    CHECK_THAT(lines[1], Catch::StartsWith("0.001000000,0.0") && Catch::Contains(",a,3C,none,b,16") &&
                             Catch::EndsWith(",0,0"));
    CHECK_THAT(lines[2], Catch::Contains(",far,81,none,,0.0,0,0"));
    CHECK_THAT(lines[3], Catch::Contains(",a,11,none,b,16") && Catch::EndsWith(",0,1"));
    CHECK_THAT(lines[4], Catch::Contains(",b,22,none,a,16") && Catch::EndsWith(",0,1"));
    std::filesystem::remove(file);
}
