// A main board that is an I2C slave, saved and marked in every state of it: in the middle of an address or of
// a byte, SCL held, a byte waiting in I2CTRN, half of a ten-bit address heard, another master's transfer
// under way. The master keeps to nothing: what comes next is drawn whatever the board answered.

#include "emu/pic/pic_node.h"
#include "tests/i2c/slave_programs.h"
#include "tests/kit/node_under_test.h"
#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::I2cPhaseKind;
using cosim::Message;
using cosim::Time;

namespace {

constexpr Time kPeriod = 10 * cosim::kMicrosecond;
constexpr cosim::PortIndex kSlave = 4;  // after UARTs, bus and world

MakeBoard slave_board(const std::string& source) {
    const image::Image image = assembled(dspic::dspic30f6014a(), source);
    return [image] {
        pic::PicNodeOptions options;
        options.board.name = "robot0.pic";
        options.i2c_slave = true;
        auto board = std::make_unique<pic::PicNode>(image, options);
        CHECK(board->slave_port() == kSlave);
        return board;
    };
}

/// Phases from `from` to `until`, as the bus hands them in; some break off the one before.
std::vector<Message> phases(RandomStream& random, Time from, Time until, std::uint8_t first_address_byte) {
    std::vector<Message> inbox;
    for (Time at = from;;) {
        constexpr Time kUsual = 12 * kPeriod;
        at += random.below(4) == 0 ? 1 + static_cast<Time>(random.below(9 * kPeriod)) : kUsual;
        if (at >= until) return inbox;
        cosim::I2cPhase phase;
        phase.start = at;
        phase.clock_period = kPeriod;
        const auto die = random.below(16);
        phase.kind = die < 5    ? I2cPhaseKind::Start
                     : die < 9  ? I2cPhaseKind::Write
                     : die < 13 ? I2cPhaseKind::Read
                     : die < 15 ? I2cPhaseKind::Stop
                                : I2cPhaseKind::Acknowledge;
        phase.byte = static_cast<std::uint8_t>(random.below(256));
        if (die < 4) phase.byte = static_cast<std::uint8_t>(first_address_byte | random.below(2));
        if (die == 4) phase.byte = 0;     // general call
        if (die == 8) phase.byte = 0xA5;  // the second byte of the ten-bit address
        phase.ack = random.below(2) != 0 && phase.kind == I2cPhaseKind::Read;
        inbox.push_back({at, kSlave, phase});
    }
}

Stretch stretch(RandomStream& random, Time from, Time until, std::uint8_t address_byte) {
    Stretch result{until, phases(random, from, until, address_byte), {}};
    for (std::uint64_t cuts = 1 + random.below(4); cuts > 0; --cuts)
        result.cuts.push_back(from + 1 +
                              static_cast<Time>(random.below(static_cast<std::uint64_t>(until - from))));
    result.cuts.push_back(until);
    std::sort(result.cuts.begin(), result.cuts.end());
    return result;
}

struct Program {
    std::string name, source;
    std::uint8_t address_byte;
};

std::vector<Program> programs() {
    const std::string rest = "rest: bra rest\n";
    constexpr int kGeneralCall = 0x80, kTenBits = 0x400, kStretches = 0x40;
    return {{"polls its flag", kPolling, 0x3E},
            {"stretches", register_file(0x1F, kEnabled | kGeneralCall, rest), 0x3E},
            {"does not stretch", register_file(0x1F, (kEnabled & ~kStretches) | kGeneralCall, rest), 0x3E},
            {"ten bits", register_file(0x2A5, kEnabled | kTenBits, rest), 0xF4},
            {"loads early", kEager, 0x3E},
            {"is a master too", register_file(0x1F, kEnabled, kWritesToo), 0x3E}};
}

/// Whether an answer is due, soon or when the program lets SCL go.
bool is_open(const cosim::Node& node) {
    return node.earliest_output(kSlave) != cosim::kNever;
}

std::uint64_t answers(const std::vector<Message>& sent) {
    return static_cast<std::uint64_t>(
        std::count_if(sent.begin(), sent.end(), [](const Message& m) { return m.port == kSlave; }));
}

Time within(RandomStream& random, Time longest) {
    return 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(longest)));
}

}  // namespace

TEST_CASE("an I2C slave goes on from a saved state") {
    for (const Program& program : programs()) {
        INFO(program.name);
        RandomStream random(3, program.name);
        const MakeBoard make = slave_board(program.source);
        const auto original = make();
        Time now = 0;
        int open = 0;
        std::uint64_t answered = 0;
        for (int i = 0; i < 60; ++i) {
            const Time at = now + within(random, cosim::kMillisecond);
            run(*original, stretch(random, now, at, program.address_byte));
            now = at;
            INFO("state " << i << " at " << cosim::to_seconds(at) << " s");
            open += is_open(*original);
            const auto bytes = saved(*original);
            const auto copy = loaded(make, bytes);
            const bool same_bytes = saved(*copy) == bytes;
            REQUIRE(same_bytes);
            REQUIRE(same_future(*copy, *original));
            const Stretch outside = stretch(random, now, now + 2 * cosim::kMillisecond, program.address_byte);
            now = outside.until;
            const auto sent = run(*original, outside);
            answered += answers(sent);
            const bool same_messages = sent == run(*copy, outside);
            REQUIRE(same_messages);
            REQUIRE(same_future(*copy, *original));
            CHECK(copy->finish() == original->finish());
        }
        CHECK(open > 15);
        CHECK(answered > 200);
    }
}

TEST_CASE("an I2C slave goes back") {
    for (const Program& program : programs()) {
        INFO(program.name);
        RandomStream random(4, program.name);
        const MakeBoard make = slave_board(program.source);
        const auto board = make(), twin = make();
        cosim::Rewindable& back = *board->rewindable();
        Time now = 0;
        int open = 0;
        std::uint64_t answered = 0;
        for (int i = 0; i < 120; ++i) {
            INFO("mark " << i << " at " << cosim::to_seconds(now) << " s");
            open += is_open(*board);
            back.mark();
            for (std::uint64_t times = random.below(3); times > 0; --times) {
                Time ahead = now;
                for (std::uint64_t steps = 1 + random.below(3); steps > 0; --steps) {
                    const Time until = ahead + within(random, cosim::kMillisecond);
                    run(*board, stretch(random, ahead, until, program.address_byte));
                    ahead = until;
                }
                back.rewind();
                const bool same_bytes = saved(*board) == saved(*twin);
                REQUIRE(same_bytes);
                REQUIRE(same_future(*board, *twin));
            }
            if (random.below(2) == 0) back.settle();
            const Stretch outside =
                stretch(random, now, now + within(random, cosim::kMillisecond), program.address_byte);
            now = outside.until;
            const auto sent = run(*board, outside);
            answered += answers(sent);
            const bool same_messages = sent == run(*twin, outside);
            REQUIRE(same_messages);
            REQUIRE(same_future(*board, *twin));
        }
        CHECK(open > 30);
        CHECK(answered > 150);
    }
}
