// The main board as a slave of its bus, by the hardware of its dsPIC30F6014A: what a Linux board reads and
// writes, general call, ten-bit addresses, both roles at once, arbitration lost to the master that then
// addresses it.

#include "base/random.h"
#include "shared_bus.h"
#include "slave_programs.h"

#include <catch2/catch.hpp>

#include <cerrno>

using namespace puckloop;
using namespace puckloop::cosim;
using tests::kEager;
using tests::kEnabled;
using tests::kFile;
using tests::kGeneral;
using tests::kLost;
using tests::kPolling;
using tests::kSent;
using tests::kWritesToo;
using tests::reading;
using tests::register_file;
using tests::SharedBus;
using tests::Task;
using tests::writing;

namespace {

linuxboard::I2cTransfer ten(linuxboard::I2cTransfer transfer) {
    for (auto& message : transfer.messages)
        message.ten_bits = true;
    return transfer;
}

}  // namespace

TEST_CASE("a Linux board that reads register 0 of the main board at 0x1F gets what its firmware sends") {
    SharedBus bus;
    bus.main_board = kPolling;
    bus.linux_board = {{20 * kMillisecond, reading(0x1F, 0)},
                       {30 * kMillisecond, reading(0x1F, 0, 4)},
                       {40 * kMillisecond, writing(0x1F, {1, 2, 3})},
                       {50 * kMillisecond, reading(0x1E, 0)}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 4);
    CHECK(bus.linux_results[0].error == 0);
    CHECK(bus.linux_results[0].data == "\x5A");
    CHECK(bus.linux_results[1].data == "\x5A\x5A\x5A\x5A");
    CHECK(bus.linux_results[2].error == 0);
    CHECK(bus.linux_results[3].error == EREMOTEIO);
}

TEST_CASE("a register file on the main board: what was written is read, at either clock") {
    for (const double hertz : {100e3, 400e3}) {
        for (unsigned seed = 1; seed <= 2; ++seed) {
            INFO("seed " << seed << " clock " << hertz);
            RandomStream random(seed, "test");
            SharedBus bus;
            bus.hertz = hertz;
            bus.main_board = register_file(0x1F, kEnabled, "rest: bra rest\n");
            std::map<int, std::string> expected;
            for (int i = 0; i < 4; ++i) {
                std::string bytes(1, static_cast<char>(64 * i));
                for (auto n = 1 + random.below(8); n > 0; --n)
                    bytes += static_cast<char>(random.below(256));
                expected[i] = bytes.substr(1);
                bus.linux_board.push_back({(10 + 5 * i) * kMillisecond, writing(0x1F, bytes)});
                bus.linux_board.push_back(
                    {(50 + 5 * i) * kMillisecond, reading(0x1F, static_cast<std::uint8_t>(64 * i),
                                                          static_cast<std::uint16_t>(bytes.size() - 1))});
            }
            std::stable_sort(bus.linux_board.begin(), bus.linux_board.end(),
                             [](const Task& a, const Task& b) { return a.time < b.time; });
            bus.run();
            REQUIRE(bus.linux_results.size() == 8);
            for (int i = 0; i < 4; ++i) {
                CHECK(bus.linux_results[static_cast<std::size_t>(i)].error == 0);
                CHECK(bus.linux_results[static_cast<std::size_t>(4 + i)].data == expected[i]);
            }
        }
    }
}

TEST_CASE("the byte that is in I2CTRN before the ninth clock leaves at once, or is dropped by a NACK") {
    for (const double hertz : {100e3, 400e3}) {
        INFO("clock " << hertz);
        SharedBus bus;
        bus.hertz = hertz;
        bus.main_board = kEager;
        Time at = 10 * kMillisecond;
        for (const std::uint16_t count : std::initializer_list<std::uint16_t>{1, 2, 1, 1, 2, 2})
            bus.linux_board.push_back({at += 5 * kMillisecond, reading(0x1F, 0, count)});
        bus.linux_board.push_back({at += 5 * kMillisecond, writing(0x1F, {1})});
        bus.run();
        REQUIRE(bus.linux_results.size() == 7);
        for (const std::size_t i : {0u, 2u, 3u})
            CHECK(bus.linux_results[i].data == "\x5A");
        for (const std::size_t i : {1u, 4u, 5u})
            CHECK(bus.linux_results[i].data == "\x5A\xA5");
        CHECK(bus.linux_results[6].error == 0);
    }
}

TEST_CASE("a general call reaches the main board where GCEN is set, and nobody where it is not") {
    for (const bool hears : {true, false}) {
        SharedBus bus;
        bus.main_board = register_file(0x1F, kEnabled | (hears ? 0x80 : 0), "rest: bra rest\n");
        bus.watched = {{"general", kGeneral}, {"file", kFile + 6}};
        bus.linux_board = {{20 * kMillisecond, writing(0, {6, 0x11, 0x22})},
                           {30 * kMillisecond, writing(0x1F, {8, 1})}};
        bus.run();
        CHECK(bus.linux_results.at(0).error == (hears ? 0 : EREMOTEIO));
        CHECK(bus.linux_results.at(1).error == 0);
        CHECK(bus.words["general"] == (hears ? 3 : 0));
        if (hears) CHECK(bus.words["file"] == 0x2211);
    }
}

TEST_CASE("ten-bit addresses: both bytes count, and seven-bit ones do not reach the board") {
    SharedBus bus;
    bus.main_board = register_file(0x2A5, kEnabled | 0x400, "rest: bra rest\n");
    bus.linux_board = {{20 * kMillisecond, ten(writing(0x2A5, {4, 0x77, 0x78}))},
                       {30 * kMillisecond, ten(reading(0x2A5, 4, 2))},
                       {40 * kMillisecond, ten(writing(0x2A4, {4, 1}))},
                       {50 * kMillisecond, ten(writing(0x1A5, {4, 1}))},
                       {60 * kMillisecond, writing(0x25, {4, 1})},
                       {70 * kMillisecond, ten(reading(0x2A5, 4, 1))}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 6);
    CHECK(bus.linux_results[0].error == 0);
    CHECK(bus.linux_results[1].data == "\x77\x78");
    for (const std::size_t i : {2u, 3u, 4u})
        CHECK(bus.linux_results[i].error == EREMOTEIO);
    CHECK(bus.linux_results[5].data == "\x77");
}

// UM10204, 3.1.11: the slave remembers that it was addressed until a STOP or a START for another; a read goes
// on with a repeated START and the first byte alone.
TEST_CASE("a range-and-bearing board with a ten-bit address is read after a repeated start") {
    SharedBus bus;
    bus.rab_board = tests::kTenBitBoard;
    bus.boards.push_back({.address = 0x20});
    auto mixed = ten(reading(0x2A5, 2, 2));  // with a START for another in between
    mixed.messages.insert(mixed.messages.begin() + 1, writing(0x20, {7, 0x42}).messages[0]);
    bus.linux_board = {{20 * kMillisecond, ten(writing(0x2A5, {2, 0x77, 0x78}))},
                       {30 * kMillisecond, ten(reading(0x2A5, 2, 2))},
                       {40 * kMillisecond, ten(reading(0x2A4, 2, 1))},
                       {50 * kMillisecond, mixed},
                       {60 * kMillisecond, ten(reading(0x2A5, 3, 1))}};
    bus.run();
    REQUIRE(bus.linux_results.size() == 5);
    CHECK(bus.linux_results[0].error == 0);
    CHECK(bus.linux_results[1].error == 0);
    CHECK(bus.linux_results[1].data == "\x77\x78");
    CHECK(bus.linux_results[2].error == EREMOTEIO);
    CHECK(bus.linux_results[3].data == "\x77\x78");
    CHECK(bus.boards[0].seen.at(7) == 0x42);
    CHECK(bus.linux_results[4].data == "\x78");
}

TEST_CASE("both roles: the main board writes to a board while a Linux board reads and writes it") {
    std::uint64_t lost = 0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
        INFO("seed " << seed);
        RandomStream random(seed, "test");
        SharedBus bus;
        bus.boards.push_back({.address = 0x20});
        bus.main_board = register_file(0x1F, kEnabled, kWritesToo);
        bus.watched = {{"lost", kLost}, {"sent", kSent}};
        Time at = 5 * kMillisecond;
        for (int i = 0; i < 15; ++i) {
            const auto value = static_cast<char>(random.below(256));
            bus.linux_board.push_back({at, writing(0x1F, {static_cast<char>(i), value})});
            at += static_cast<Time>(random.below(2 * kMillisecond));
            bus.linux_board.push_back({at, reading(0x1F, static_cast<std::uint8_t>(i))});
            at += 2 * kMillisecond + static_cast<Time>(random.below(kMillisecond));
        }
        bus.run();
        REQUIRE(bus.linux_results.size() == 30);
        for (std::size_t i = 0; i < 30; i += 2) {
            CHECK(bus.linux_results[i].error == 0);
            CHECK(bus.linux_results[i + 1].data == bus.linux_board[i].transfer.messages[0].data.substr(1));
        }
        CHECK(bus.words["sent"] >= 20);
        CHECK(std::abs(bus.boards[0].seen.at(7) - static_cast<int>(bus.words["sent"])) <= 1);
        lost += bus.words["lost"];
    }
    CHECK(lost > 0);
}

TEST_CASE("arbitration: the main board loses to the master that addresses it, serves it, and sends later") {
    // When it begins by itself.
    SharedBus alone;
    alone.boards.push_back({.address = 0x20});
    alone.main_board = register_file(0x1F, kEnabled, kWritesToo);
    alone.linux_board = {{50 * kMillisecond, writing(0x20, {9, 9})}};
    alone.run();
    // The pause is 4000 x 3 cycles of 67.8 ns: its address byte begins some 0.83 ms after power-up.
    int collided = 0;
    for (int i = -30; i <= 30; i += 3) {
        INFO("offset " << i << " us");
        SharedBus bus = alone;
        bus.boards = {{.address = 0x20}};
        bus.watched = {{"lost", kLost}, {"sent", kSent}};
        bus.linux_board = {{830 * kMicrosecond + i * kMicrosecond, writing(0x1F, {3, 0x66})},
                           {50 * kMillisecond, reading(0x1F, 3)}};
        bus.run();
        CHECK(bus.linux_results.at(0).error == 0);
        CHECK(bus.linux_results.at(1).data == "\x66");
        CHECK(bus.words["sent"] > 20);
        collided += bus.words["lost"] > 0;
    }
    CHECK(collided > 0);
}
