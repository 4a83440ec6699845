// Boards in nodes of their own on a bus with two masters: stretching, refusals, arbitration, one address
// twice, a board that keeps SCL low. Every run is repeated with its grants cut at random places.

#include "shared_bus.h"

#include <catch2/catch.hpp>

#include <cerrno>

using namespace puckloop::cosim;
using puckloop::tests::reading;
using puckloop::tests::SharedBus;
using puckloop::tests::writing;

namespace {
constexpr Time kPeriod = 10 * kMicrosecond;
constexpr Time kPicPeriod = 11'140'000;
constexpr Time kByte = 9 * kPeriod;
constexpr Time kStop = kPeriod;
}  // namespace

TEST_CASE("a register of a board, written and read back by Linux with a repeated start") {
    SharedBus bus;
    bus.boards = {{.address = 0x20}};
    bus.linux_board = {{kMillisecond, writing(0x20, "\x07\x42")},
                       {2 * kMillisecond, reading(0x20, 7)},
                       {3 * kMillisecond, reading(0x20, 8)}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 3);
    CHECK(bus.linux_results[0].time == kMillisecond + 3 * kByte + kStop);
    CHECK(bus.linux_results[1].data == "\x42");
    CHECK(bus.linux_results[1].time == 2 * kMillisecond + 4 * kByte + kStop);
    CHECK(bus.linux_results[2].data == "\x5A");
    CHECK(bus.boards[0].seen.at(7) == 0x42);
}

TEST_CASE("at 400 kHz everything takes a quarter of the time") {
    SharedBus bus;
    bus.hertz = 400e3;
    bus.boards = {{.address = 0x20}};
    bus.linux_board = {{kMillisecond, reading(0x20, 8)}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 1);
    CHECK(bus.linux_results[0].data == "\x5A");
    CHECK(bus.linux_results[0].time == kMillisecond + (4 * kByte + kStop) / 4);
}

TEST_CASE("a board that stretches by 2 ms, and the other master meanwhile") {
    SharedBus bus;
    bus.boards = {{.address = 0x20, .stretch = 2 * kMillisecond}};
    bus.linux_board = {{kMillisecond, writing(0x20, "\x0E\x01")}};
    SECTION("Linux waits for the slow board") {
        bus.run();
        REQUIRE(bus.linux_results.size() == 1);
        CHECK(bus.linux_results[0].error == 0);
        CHECK(bus.linux_results[0].time == kMillisecond + 3 * kByte + 4 * kMillisecond + kStop);
        CHECK_THAT(bus.report, Catch::Contains("\"stretched\":2,\"longest_stretch_us\":2000.000"));
        CHECK_THAT(bus.report, Catch::Contains("\"warnings\":[]"));
    }
    SECTION("a dsPIC that wants the bus in between collides, and gets it afterwards") {
        bus.pic = {{2 * kMillisecond, reading(0x20, 1)}, {20 * kMillisecond, reading(0x20, 1)}};
        bus.run();
        REQUIRE(bus.pic_results.size() == 2);
        CHECK(bus.pic_results[0].error == EAGAIN);
        CHECK(bus.pic_results[1].error == 0);
        CHECK(bus.linux_results[0].error == 0);
    }
    SECTION("Linux waits for the end of a dsPIC's transfer") {
        bus.linux_board.clear();
        bus.pic = {{kMillisecond, reading(0x20, 1)}};
        bus.linux_board = {{2 * kMillisecond, reading(0x20, 1)}};
        bus.run();
        REQUIRE(bus.pic_results.size() == 1);
        REQUIRE(bus.linux_results.size() == 1);
        const Time pic_done = kMillisecond + 36 * kPicPeriod + 2 * kMillisecond + kPicPeriod;
        CHECK(bus.pic_results[0].time == pic_done);
        CHECK(bus.linux_results[0].error == 0);
        CHECK(bus.linux_results[0].time == pic_done + 4 * kByte + 2 * kMillisecond + kStop);
    }
}

TEST_CASE("of two masters that start together the lower address byte goes on") {
    SharedBus bus;
    bus.boards = {{.address = 0x20}, {.address = 0x30, .fill = 0x33}};
    bus.linux_board = {{kMillisecond, reading(0x30, 1)}};
    bus.pic = {{kMillisecond + 3 * kMicrosecond, reading(0x20, 1)}};
    bus.run();
    REQUIRE(bus.pic_results.size() == 1);
    CHECK(bus.pic_results[0].data == "\x5A");
    REQUIRE(bus.linux_results.size() == 1);
    CHECK(bus.linux_results[0].error == EAGAIN);  // arbitration lost, as i2c-omap reports it
}

TEST_CASE("a board that is not there or not yet on") {
    SharedBus bus;
    bus.boards = {{.address = 0x20, .off_until = 9 * kMillisecond}};
    bus.linux_board = {{kMillisecond, reading(0x20, 0)},
                       {10 * kMillisecond, reading(0x20, 0)},
                       {11 * kMillisecond, reading(0x21, 0)}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 3);
    CHECK(bus.linux_results[0].error == EREMOTEIO);
    CHECK(bus.linux_results[0].time == kMillisecond + kByte + kStop);
    CHECK(bus.linux_results[1].error == 0);
    CHECK(bus.linux_results[2].error == EREMOTEIO);
    CHECK_THAT(bus.report, Catch::Contains("linux addressed 0x20 once and nobody acknowledged"));
    CHECK_THAT(bus.report, Catch::Contains("linux addressed 0x21 once and nobody acknowledged"));
}

TEST_CASE("two boards at one address answer together") {
    SharedBus bus;
    bus.boards = {{.address = 0x20, .fill = 0x3C, .stretch = 100 * kMicrosecond},
                  {.address = 0x20, .fill = 0x0F}};
    bus.linux_board = {{kMillisecond, reading(0x20, 1)}, {2 * kMillisecond, writing(0x20, "\x05\x77")}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 2);
    CHECK(bus.linux_results[0].data == std::string(1, 0x3C & 0x0F));
    CHECK(bus.linux_results[0].time == kMillisecond + 4 * kByte + 100 * kMicrosecond + kStop);
    CHECK(bus.boards[0].seen.at(5) == 0x77);
    CHECK(bus.boards[1].seen.at(5) == 0x77);
    CHECK_THAT(bus.report, Catch::Contains("0x20 was acknowledged by board0, board1 together, 3 times"));
}

TEST_CASE("a board at the ground sensor's address spoils its registers") {
    SharedBus bus;
    bus.ground_sensor = true;
    bus.boards = {{.address = 0x60, .fill = 0x00}};
    bus.linux_board = {{kMillisecond, reading(0x60, 0)}};
    bus.run();
    CHECK(bus.linux_results[0].data == std::string(1, '\0'));
    CHECK_THAT(bus.report,
               Catch::Contains("0x60 was acknowledged by ground_sensor, board0 together, 2 times"));
}

TEST_CASE("a board that keeps SCL low: the driver gives up after a second and frees the bus later") {
    SharedBus bus;
    bus.duration = 3 * kSecond;
    bus.ground_sensor = true;
    // The second byte written (of register 7) is held.
    bus.boards = {{.address = 0x20, .hold = 1500 * kMillisecond, .hold_byte = 1}};
    bus.linux_board = {{kMillisecond, writing(0x20, "\x07\x42")},
                       {1100 * kMillisecond, reading(0x60, 12)},  // for whomever: the bus is stuck
                       {2800 * kMillisecond, reading(0x20, 7)}};
    bus.pic = {{1200 * kMillisecond, reading(0x60, 12)}, {2900 * kMillisecond, reading(0x60, 12)}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 3);
    CHECK(bus.linux_results[0].error == ETIMEDOUT);
    CHECK(bus.linux_results[0].time == 1001 * kMillisecond + kStop);
    // It waits until the board lets go, acknowledging: nine clocks and a STOP free SDA.
    const Time let_go = kMillisecond + 2 * kByte + 8 * kPeriod + 1500 * kMillisecond;
    CHECK(bus.linux_results[1].error == 0);
    CHECK(bus.linux_results[1].time == let_go + 10 * kPeriod + 4 * kByte + kStop);
    CHECK(bus.linux_results[2].data == "\x42");
    REQUIRE(bus.pic_results.size() == 2);
    CHECK(bus.pic_results[0].error == EAGAIN);
    CHECK(bus.pic_results[1].error == 0);
    CHECK_THAT(bus.report, Catch::Contains("\"stuck\":1"));
    CHECK_THAT(bus.report, Catch::Contains("the bus was stuck once, 500.") &&
                               Catch::Contains("board0 held SCL low until the master gave up"));
}

TEST_CASE("a board that never lets SCL go") {
    SharedBus bus;
    bus.duration = 4 * kSecond;
    bus.boards = {{.address = 0x20, .hold = kNever / 4, .hold_byte = 0}};
    bus.linux_board = {{kMillisecond, writing(0x20, "\x07\x42")}, {kMillisecond, reading(0x20, 7)}};
    SECTION("every transfer of Linux times out") {
        bus.run();
        REQUIRE(bus.linux_results.size() == 2);
        CHECK(bus.linux_results[0].error == ETIMEDOUT);
        CHECK(bus.linux_results[1].error == ETIMEDOUT);
        CHECK(bus.linux_results[1].time == 2001 * kMillisecond + 2 * kStop);
        CHECK_THAT(bus.report, Catch::Contains("and still is: board0 held SCL low"));
    }
    SECTION("a dsPIC alone waits for ever, and the report says for what") {
        bus.linux_board.clear();
        bus.pic = {{kMillisecond, writing(0x20, "\x07\x42")}};
        bus.pic[0].transfer.timeout = kNever / 4;
        bus.run();
        CHECK(bus.pic_results.empty());
        CHECK_THAT(bus.report, Catch::Contains("SCL is held low by board0 since 0.001100 s"));
    }
}
