// The driver of the range-and-bearing board against a model of its register map.

#include "linuxboard/control/rab/rab_board.h"
#include "tests/linuxboard/simulated_rab.h"

#include <catch2/catch.hpp>

#include <cerrno>

using namespace puckloop::control;

namespace {

struct Bench {
    explicit Bench(RabBoardSettings settings = {}) : board(device, clock, settings) {}
    RabPacket packet() {
        RabPacket out;
        REQUIRE(board.poll(out) == RabPoll::Message);
        return out;
    }
    SimulatedClock clock;
    SimulatedRab device{clock};
    RabBoard board;
};

using Writes = std::vector<std::pair<std::uint8_t, std::uint8_t>>;

}  // namespace

TEST_CASE("a transfer that timed out is not tried again") {
    SimulatedClock clock;
    SimulatedRab device(clock);
    RabBoard board(device, clock, {.bytes = 2});
    device.refuse = 1;
    device.error = ETIMEDOUT;
    CHECK_FALSE(board.repeat_range());
    CHECK(board.counters().retries == 0);
    CHECK(board.last_error() == ETIMEDOUT);
    CHECK(board.repeat_range());
    device.refuse = 1;
    device.error = EREMOTEIO;
    CHECK(board.repeat_range());
    CHECK(board.counters().retries == 1);
}

TEST_CASE("the board is set up in ARGoS's order, with 20 ms around the darkness, and emptied") {
    Bench bench({.bytes = 3, .range = 0});
    for (int i = 0; i < 4; ++i)
        bench.device.receive({.data = 7});
    REQUIRE(bench.board.initialise());
    CHECK(bench.device.writes == Writes{{12, 0}, {21, 24}, {17, 0}, {16, 0}, {21, 24}});
    CHECK(bench.device.bits == 24);
    CHECK(bench.device.waiting() == 0);
    CHECK(bench.clock.time > 0.040);
    CHECK(bench.clock.time < 0.060);
}

TEST_CASE("payloads of every size go to all emitters in one operation") {
    const std::uint32_t payloads[] = {0x5A, 0xA5C3, 0x010203, 0xDEADBEEF};
    for (int bytes = 1; bytes <= 4; ++bytes) {
        Bench bench({.bytes = bytes});
        REQUIRE(bench.board.initialise());
        bench.board.send_all(0xFFFFFFFF);  // leaves a high part behind
        const unsigned long before = bench.device.transfers;
        REQUIRE(bench.board.send_all(payloads[bytes - 1]));
        CHECK(bench.device.transfers == before + 1);
        REQUIRE(bench.device.frames.size() == 2);
        for (const auto& payload : bench.device.frames[1].payloads)
            CHECK(payload == payloads[bytes - 1]);
    }
}

TEST_CASE("different payloads are stored first and sent once, emitters without one stay dark") {
    for (int bytes = 1; bytes <= 4; ++bytes) {
        Bench bench({.bytes = bytes});
        REQUIRE(bench.board.initialise());
        const std::uint32_t mask = bytes == 4 ? 0xFFFFFFFF : (1U << 8 * bytes) - 1;
        SimulatedRab::Payloads payloads;
        payloads[0] = 0x12345678 & mask;
        payloads[5] = 0x9ABCDEF0 & mask;
        payloads[11] = 0x00000001;
        REQUIRE(bench.board.send_each(payloads));
        REQUIRE(bench.device.frames.size() == 1);
        CHECK(bench.device.frames[0].payloads == payloads);
        payloads.fill(0x11);
        const std::size_t before = bench.device.writes.size();
        REQUIRE(bench.board.send_each(payloads));
        CHECK(bench.device.writes.back() == Writes::value_type{14, 0x11});
        CHECK(bench.device.writes.size() - before == static_cast<std::size_t>(bytes));
    }
}

TEST_CASE("messages arrive whole, with signed bearings, read singly and in runs") {
    for (const bool burst : {false, true}) {
        for (int bytes = 1; bytes <= 4; ++bytes) {
            Bench bench({.bytes = bytes, .burst = burst});
            REQUIRE(bench.board.initialise());
            const std::uint32_t mask = bytes == 4 ? 0xFFFFFFFF : (1U << 8 * bytes) - 1;
            for (const int bearing : {-28797, -2617, 0, 2617, 31415})
                bench.device.receive({.data = 0xDEADBEEF & mask,
                                      .bearing = static_cast<std::int16_t>(bearing),
                                      .strength = 4975});
            for (const int bearing : {-28797, -2617, 0, 2617, 31415}) {
                const RabPacket packet = bench.packet();
                CHECK(packet.payload == (0xDEADBEEF & mask));
                CHECK(packet.bearing == Approx(bearing * 1e-4));
                CHECK(packet.strength == 4975);
                CHECK(packet.time == bench.clock.time);
            }
            RabPacket none;
            CHECK(bench.board.poll(none) == RabPoll::Empty);
        }
    }
}

TEST_CASE("a run of registers takes half the time of single ones") {
    double taken[2] = {};
    for (const bool burst : {false, true}) {
        Bench bench({.bytes = 2, .burst = burst});
        bench.device.receive({.data = 1});
        bench.packet();
        taken[burst ? 1 : 0] = bench.clock.time;
    }
    CHECK(taken[1] < 0.6 * taken[0]);
}

TEST_CASE("a board that counts registers otherwise is found out and read singly") {
    Bench bench({.bytes = 4, .burst = true});
    bench.device.counts_like_the_board = false;
    REQUIRE(bench.board.initialise());
    bench.device.receive({.data = 0xDEADBEEF, .bearing = -5, .strength = 777});
    const RabPacket packet = bench.packet();
    CHECK(packet.payload == 0xDEADBEEF);
    CHECK(packet.bearing == Approx(-5e-4));
    CHECK(packet.strength == 777);
    CHECK_FALSE(bench.board.settings().burst);
}

TEST_CASE("transfers are tried again a few times, counted, and given up") {
    Bench bench({.tries = 4});
    bench.device.refuse = 3;
    REQUIRE(bench.board.send_all(1));
    CHECK(bench.board.counters().retries == 3);
    CHECK(bench.board.counters().failures == 0);
    bench.device.refuse = 4;
    CHECK_FALSE(bench.board.send_all(1));
    CHECK(bench.board.counters().failures == 1);
    CHECK(bench.board.last_error() == bench.device.error);
    CHECK(bench.board.failed_in_a_row() == 1);
    RabPacket packet;
    bench.device.refuse = 1000000;
    CHECK(bench.board.poll(packet) == RabPoll::Failed);
    CHECK_FALSE(bench.board.initialise());
    CHECK(bench.board.counters().failures == 3);
    bench.device.refuse = 0;
    CHECK(bench.board.poll(packet) == RabPoll::Empty);
    CHECK(bench.board.failed_in_a_row() == 0);
}
