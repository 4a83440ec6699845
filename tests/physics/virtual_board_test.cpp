// Range-and-bearing boards that are not there: what real ones hear of them.

#include "base/error.h"
#include "physics/ir/ir_node.h"
#include "physics/world/pose_signals.h"
#include "protocols/infrared/rab_frame.h"
#include "tests/kit/scratch.h"
#include "tests/physics/events/plans.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

constexpr Time kChip = 98'090'000;  // ps

VirtualBoard caller(double x, double jitter = 0.0) {
    return {.name = "caller", .x = x, .data = {0x12, 0x34}, .begin = 0.01, .every = 0.05, .jitter = jitter};
}

World listener_and(const VirtualBoard& board) {
    World world = ideal_pair(0.3);
    world.robots.pop_back();
    world.virtuals.boards.push_back(board);
    return world;
}

/// What a real board at port 1 sends when it is driven by these chips.
std::vector<Message> frame(Time start, const std::string& chips) {
    std::vector<Message> messages;
    bool on = false;
    for (std::size_t i = 0; i <= chips.size(); ++i) {
        const bool next = i < chips.size() && chips[i] == '1';
        for (std::uint16_t k = 0; k < kIrSensors && next != on; ++k)
            messages.push_back({start + static_cast<Time>(i) * kChip, 1,
                                Signal{static_cast<std::uint16_t>(kEmitter + k), next ? 1.0 : 0.0}});
        on = next;
    }
    return messages;
}

std::vector<Message> of_port(const std::vector<Message>& all, cosim::PortIndex port) {
    std::vector<Message> found;
    for (const Message& message : all)
        if (message.port == port) found.push_back(message);
    return found;
}

std::vector<Message> run_ir(IrNode& node, const std::vector<Message>& inputs, Time slice) {
    return run_node(node, inputs, 200 * kMillisecond, slice);
}

}  // namespace

TEST_CASE("a virtual board is heard as a real one at its place") {
    IrNode with_virtual(listener_and(caller(2 * kBodyRadius + 0.3)), {});
    const auto heard = of_port(run_ir(with_virtual, {}, 10 * kMillisecond), 0);
    std::vector<Message> inputs{{kMicrosecond, 1, Signal{kCarrierId, kFirmwareCarrier}},
                                {kMicrosecond, 1, Signal{kPowerId, 115}}};
    for (Time start = 10 * kMillisecond; start < 200 * kMillisecond; start += 50 * kMillisecond)
        for (const Message& message : frame(start, protocols::encode_rab(16, 0x1234)))
            inputs.push_back(message);
    IrNode with_real(ideal_pair(0.3), {});
    const auto real = of_port(run_ir(with_real, inputs, 10 * kMillisecond), 0);
    REQUIRE(heard.size() > 100);
    REQUIRE(heard.size() == real.size());
    for (std::size_t i = 0; i < heard.size(); ++i) {
        CHECK(heard[i].time == real[i].time);
        CHECK(std::get<Signal>(heard[i].payload).id == std::get<Signal>(real[i].payload).id);
        CHECK(std::get<Signal>(heard[i].payload).value == std::get<Signal>(real[i].payload).value);
    }
}

TEST_CASE("however a virtual board's time is cut, and gone back over, it says the same") {
    const World world = listener_and(caller(0.4, 0.002));
    IrNode whole(world, {}), cut(world, {}), back(world, {});
    const auto expected = run_ir(whole, {}, 200 * kMillisecond);
    const auto sliced = run_ir(cut, {}, 137 * kMicrosecond);
    REQUIRE(expected.size() == sliced.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        CHECK(expected[i].time == sliced[i].time);
    std::vector<Message> out, again;
    cosim::Rewindable& state = *back.rewindable();
    back.advance(23 * kMillisecond, {}, out);
    const std::size_t before = out.size();
    state.mark();
    back.advance(90 * kMillisecond, {}, out);
    state.rewind();
    back.advance(90 * kMillisecond, {}, again);
    REQUIRE(again.size() == out.size() - before);
    for (std::size_t i = 0; i < again.size(); ++i)
        CHECK(again[i].time == out[before + i].time);
}

TEST_CASE("a virtual board that moves away is not heard any more") {
    World world = listener_and(caller(0.4));
    link_up(world);
    const auto node = node_with(world, {at(70 * kMillisecond, move_to("caller", 1.9, 1.9))});
    const auto sent = run_node(*node, {}, 200 * kMillisecond, 10 * kMillisecond);
    constexpr cosim::PortIndex kIr = 2;
    const auto id = static_cast<std::uint16_t>(virtual_board_signal(0, 0));
    CHECK(changes(sent, kIr, id) == std::vector<std::pair<Time, double>>{{71 * kMillisecond, 1.9}});
    IrNode medium(world, {.changes = true});
    std::vector<Message> inbox;
    for (const Message& message : of_port(sent, kIr))
        inbox.push_back({message.time, 1, message.payload});
    std::vector<Message> out;
    medium.advance(200 * kMillisecond, inbox, out);
    REQUIRE(!out.empty());
    Time last = 0;
    for (const Message& message : out)
        if (std::get<Signal>(message.payload).id < kPeak) last = std::max(last, message.time);
    CHECK(last > 60 * kMillisecond);
    CHECK(last < 80 * kMillisecond);  // of the frame that began at 60 ms
}

TEST_CASE("ir.csv has the frames of virtual boards, and none as heard by them") {
    const auto file = puckloop::tests::scratch_path("virtual_board_ir.csv");
    {
        IrNodeOptions options;
        options.frames_csv = file.string();
        IrNode node(listener_and(caller(0.4)), options);
        run_ir(node, {}, 50 * kMillisecond);
        CHECK(node.finish().find("\"caller\"") == std::string::npos);
    }
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::size_t rows = 0;
    while (std::getline(in, line)) {
        ++rows;
        CHECK(line.find(",caller,a,") != std::string::npos);
    }
    CHECK(rows == 4);  // at 10, 60, 110, 160 ms
}

TEST_CASE("virtual boards that cannot be are refused") {
    VirtualBoard board = caller(0.4);
    board.every = 0.001;
    CHECK_THROWS_WITH(check(listener_and(board)), Catch::Contains("virtual_board 'caller': every"));
    board = caller(0.4);
    board.data.assign(5, 1);
    CHECK_THROWS_WITH(check(listener_and(board)), Catch::Contains("data has 5 bytes"));
    World deaf = listener_and(caller(0.4));
    deaf.robots[0].rab = false;
    CHECK_THROWS_WITH(check(deaf), Catch::Contains("no robot has a range-and-bearing board"));
    World many = listener_and(caller(0.4));
    for (int i = 0; i < 70; ++i) {
        many.virtuals.boards.push_back(caller(0.4));
        many.virtuals.boards.back().name = "caller" + std::to_string(i);
    }
    CHECK_THROWS_WITH(check(many), Catch::Contains("at most 64"));
}
