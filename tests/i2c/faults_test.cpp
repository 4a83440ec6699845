// Faults on the I2C bus: two masters, a board that is a node, devices in the bus; each kind with values drawn
// at random. What Linux makes of them as in its Documentation/i2c/fault-codes.rst.

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "cosim/faults/kinds/kind_table.h"
#include "cosim/i2c/i2c_fault.h"
#include "shared_bus.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cerrno>

using namespace puckloop;
using namespace puckloop::cosim;
using tests::Board;
using tests::reading;
using tests::SharedBus;
using tests::writing;

namespace {

constexpr Time kClock = 10 * kMicrosecond;

/// What the run made of each fault.
nlohmann::json evidence(const SharedBus& bus) {
    return nlohmann::json::parse(bus.report).at("faults");
}

struct Where {
    std::string from{};
    std::optional<int> address{}, reg{}, position{};
    std::string phase = "any";
};

/// As the reader makes them: complete and checked.
FaultSpec fault(const std::string& kind, const Where& where = {}) {
    FaultSpec spec;
    spec.link = "i2c";
    spec.name = kind;
    spec.kind = kind;
    spec.from = where.from;
    if (where.address) spec.set("address", *where.address);
    if (where.reg) spec.set("register", *where.reg);
    if (where.position) spec.set("position", *where.position);
    spec.set("phase", where.phase);
    return spec;
}

double seconds(Time time) {
    return to_seconds(time);
}

/// Values that a test draws; its seed is in the message of what fails.
class Draw {
  public:
    explicit Draw(unsigned seed) : random_(seed, "test") {}
    std::uint8_t byte() { return static_cast<std::uint8_t>(random_.below(256)); }
    int below(int n) { return static_cast<int>(random_.below(static_cast<std::uint64_t>(n))); }
    std::uint8_t address() { return static_cast<std::uint8_t>(0x10 + below(0x50)); }
    Time time(Time least, Time most) {
        return least + static_cast<Time>(random_.below(static_cast<std::uint64_t>(most - least)));
    }

  private:
    RandomStream random_;
};

/// Writes of `count` bytes to registers of a board, one every 5 ms, then a read of the first.
SharedBus writes(std::uint8_t address, int count, int length) {
    SharedBus bus;
    bus.boards.push_back({.address = address});
    for (int i = 0; i < count; ++i) {
        std::string bytes(1, static_cast<char>(i));
        for (int k = 1; k < length; ++k)
            bytes += static_cast<char>(i * 16 + k);
        bus.linux_board.push_back({(1 + 5 * i) * kMillisecond, writing(address, bytes)});
    }
    return bus;
}

}  // namespace

TEST_CASE("nack of an address: the driver's error, and nothing reaches the board") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        Draw draw(seed);
        const std::uint8_t address = draw.address();
        const int meant = draw.below(6);
        SharedBus bus = writes(address, 6, 3);
        bus.faults = {fault("nack", {.address = address, .phase = "address"})};
        bus.faults[0].skip = static_cast<std::uint64_t>(meant);
        bus.faults[0].count = 1;
        bus.run();
        INFO("seed " << seed);
        REQUIRE(bus.linux_results.size() == 6);
        for (int i = 0; i < 6; ++i) {
            CHECK(bus.linux_results[static_cast<std::size_t>(i)].error == (i == meant ? EREMOTEIO : 0));
            CHECK(bus.boards[0].seen.contains(static_cast<std::uint8_t>(i)) == (i != meant));
        }
        const auto told = evidence(bus);
        CHECK(told[0]["fired"] == 1);
        CHECK(told[0]["firings"][0][0].get<double>() * 1e-12 == Approx(0.001 + 0.005 * meant));
    }
}

TEST_CASE("nack of every k-th data byte, by position and register") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        Draw draw(seed);
        const auto position = static_cast<int>(2 + draw.below(3));
        const int k = 2 + draw.below(2);
        SharedBus bus = writes(0x20, 8, 5);
        bus.faults = {fault("nack", {.position = position, .phase = "write"})};
        bus.faults[0].every = static_cast<std::uint64_t>(k);
        const auto number = static_cast<std::uint8_t>(draw.below(8));
        bus.faults.push_back(fault("nack", {.reg = number, .position = 1}));
        bus.run();
        INFO("seed " << seed << " position " << position << " every " << k << " register " << int(number));
        REQUIRE(bus.linux_results.size() == 8);
        int asked = 0, refused = 0;
        for (int i = 0; i < 8; ++i) {
            const bool first_byte = i == number;  // the register's number itself
            const bool data = !first_byte && asked++ % k == 0;
            refused += data;
            CHECK(bus.linux_results[static_cast<std::size_t>(i)].error ==
                  (first_byte || data ? EREMOTEIO : 0));
        }
        CHECK(evidence(bus)[0]["fired"] == refused);
        CHECK(evidence(bus)[1]["fired"] == 1);
    }
}

TEST_CASE("flip: chosen and drawn bits of bytes written, read and of addresses") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        INFO("seed " << seed);
        Draw draw(seed);
        const std::uint8_t value = draw.byte();
        const int bit = draw.below(8), read_bit = draw.below(8), address_bit = 1 + draw.below(7);
        SharedBus bus;
        bus.boards.push_back({.address = 0x20, .fill = value});
        const auto other = static_cast<std::uint8_t>(0x20 ^ 1 << (address_bit - 1));
        bus.boards.push_back({.address = other, .fill = 0x77});
        bus.linux_board = {{kMillisecond, writing(0x20, {1, static_cast<char>(value)})},
                           {5 * kMillisecond, reading(0x20, 9)},
                           {10 * kMillisecond, writing(0x20, {5, 6})}};
        bus.faults = {fault("flip", {.position = 2, .phase = "write"}), fault("flip", {.phase = "read"}),
                      fault("flip", {.phase = "address"})};
        bus.faults[0].end = bus.faults[1].end = 9 * kMillisecond;
        bus.faults[2].begin = 9 * kMillisecond;
        bus.faults[0].set("bit", bit);
        bus.faults[1].set("bit", read_bit);
        bus.faults[2].set("bit", address_bit);
        bus.run();
        CHECK(bus.boards[0].seen.at(1) == (value ^ 1 << bit));
        REQUIRE(bus.linux_results.size() == 3);
        CHECK(static_cast<std::uint8_t>(bus.linux_results[1].data.at(0)) == (value ^ 1 << read_bit));
        CHECK(bus.boards[1].seen.at(5) == 6);  // went to the wrong board
        CHECK(evidence(bus)[1]["firings"][0][2].get<std::string>().find(fmt::format("bit {}", read_bit)) !=
              std::string::npos);

        bus.faults.resize(1);
        bus.faults[0] = fault("flip", {.position = 2, .phase = "write"});
        bus.run();  // the same bit in every run
        const int wrong = bus.boards[0].seen.at(1) ^ value;
        CHECK((wrong != 0 && (wrong & (wrong - 1)) == 0));
    }
}

TEST_CASE("stretch and a line held low: late, or ETIMEDOUT and nothing lost afterwards") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        INFO("seed " << seed);
        Draw draw(seed);
        const Time held = draw.time(kMillisecond, 3 * kMillisecond);
        SharedBus plain = writes(0x20, 4, 3);
        plain.run();
        for (const char* const kind : {"stretch", "scl"}) {
            SharedBus bus = writes(0x20, 4, 3);
            bus.faults = {fault(kind, {.position = static_cast<int>(draw.below(3))})};
            bus.faults[0].skip = 1;
            bus.faults[0].count = 1;
            bus.faults[0].set("time", seconds(held));
            bus.run();
            REQUIRE(bus.linux_results.size() == 4);
            for (std::size_t i = 0; i < 4; ++i) {
                CHECK(bus.linux_results[i].error == 0);
                CHECK(bus.linux_results[i].time - plain.linux_results[i].time == (i == 1 ? held : 0));
            }
            CHECK(bus.boards[0].seen == plain.boards[0].seen);

            bus.boards = {{}};
            for (auto& task : bus.linux_board)
                task.transfer.timeout = held / 2;
            bus.run();
            CHECK(bus.linux_results[1].error == ETIMEDOUT);
            CHECK(bus.linux_results[0].error == 0);
            CHECK(bus.linux_results[2].error == 0);
            CHECK(bus.linux_results[3].error == 0);
        }
    }
}

TEST_CASE("SDA or SCL low on an idle bus: Linux waits or gives up, the dsPIC sees a collision") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        for (const char* const kind : {"sda", "scl"}) {
            INFO("seed " << seed << " " << kind);
            Draw draw(seed);
            SharedBus bus;
            bus.boards.push_back({});
            const Time begin = draw.time(2 * kMillisecond, 4 * kMillisecond);
            const Time low = draw.time(3 * kMillisecond, 8 * kMillisecond);
            bus.linux_board = {{begin + kMillisecond, writing(0x20, {1, 2})},
                               {begin + low + 5 * kMillisecond, writing(0x20, {3, 4})}};
            bus.pic = {{begin + 2 * kMillisecond, writing(0x20, {5, 6})},
                       {begin + low + 10 * kMillisecond, writing(0x20, {7, 8})}};
            bus.faults = {fault(kind)};
            bus.faults[0].begin = begin;
            bus.faults[0].set("time", seconds(low));
            bus.run();
            REQUIRE(bus.linux_results.size() == 2);
            REQUIRE(bus.pic_results.size() == 2);
            CHECK(bus.linux_results[0].error == 0);
            CHECK(bus.linux_results[0].time >= begin + low);
            CHECK(bus.pic_results[0].error == EAGAIN);
            CHECK(bus.pic_results[1].error == 0);
            CHECK(evidence(bus)[0]["fired"] == 1);
            bus.linux_board[0].transfer.timeout = kMillisecond;
            bus.boards = {{}};
            bus.run();
            CHECK(bus.linux_results[0].error == ETIMEDOUT);
            CHECK(bus.linux_results[0].time == begin + 2 * kMillisecond + kClock);
            CHECK(bus.linux_results[1].error == 0);
            CHECK(bus.boards[0].seen.count(1) == 0);
            CHECK(bus.boards[0].seen.at(3) == 4);
        }
    }
}

TEST_CASE("SDA or SCL low on a bus that nobody uses meanwhile: the evidence states it") {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        for (const char* const kind : {"sda", "scl"}) {
            INFO("seed " << seed << " " << kind);
            Draw draw(seed);
            SharedBus bus;
            bus.boards.push_back({});
            const Time begin = draw.time(20 * kMillisecond, 40 * kMillisecond);
            const Time low = draw.time(kMicrosecond, 20 * kMillisecond);
            if (seed % 2 == 0) bus.linux_board = {{kMillisecond, writing(0x20, {1, 2})}};
            if (seed % 3 == 0) bus.pic = {{begin + low + kMillisecond, writing(0x20, {3, 4})}};
            // Over before, beyond the end, and one that the run never comes to.
            bus.faults = {fault(kind), fault(kind), fault(kind)};
            bus.faults[0].begin = begin;
            bus.faults[0].set("time", seconds(low));
            bus.faults[1].begin = 90 * kMillisecond;
            bus.faults[1].set("time", 1.0);
            bus.faults[2].begin = bus.duration;
            bus.faults[2].set("time", seconds(low));
            bus.run();
            const auto found = evidence(bus);
            CHECK(found[0]["fired"] == 1);
            CHECK(found[0]["firings"][0][0] == begin);
            const auto text = found[0]["firings"][0].back().get<std::string>();
            CHECK(text.starts_with(std::string(kind) + " low from "));
            CHECK(text.ends_with(" on a bus at rest"));
            CHECK(found[1]["fired"] == 1);
            CHECK(found[1]["firings"][0][0] == 90 * kMillisecond);
            CHECK(found[2]["fired"] == 0);
            for (const auto& result : bus.linux_results)
                CHECK(result.error == 0);
            for (const auto& result : bus.pic_results)
                CHECK(result.error == 0);
        }
    }
}

TEST_CASE("SDA low for less than half a clock of a byte: no bit is spoiled, and the evidence states when") {
    SharedBus bus;
    bus.boards.push_back({});
    bus.linux_board = {{kMillisecond, writing(0x20, {1, '\x7F'})}};
    bus.faults = {fault("sda", {.position = 2})};
    bus.faults[0].set("time", seconds(kClock / 4));
    bus.run();
    CHECK(bus.linux_results.at(0).error == 0);
    CHECK(bus.boards[0].seen.at(1) == 0x7F);
    const auto found = evidence(bus);
    CHECK(found[0]["fired"] == 1);
    CHECK(found[0]["firings"][0].back().get<std::string>().ends_with(" between two samples of the line"));
}

TEST_CASE("SDA low in a transfer: a 1 loses the bus, a 0 passes, bytes read are zero") {
    SharedBus bus;
    bus.boards.push_back({.address = 0x20, .fill = 0xFF});
    bus.linux_board = {{kMillisecond, writing(0x20, {1, 0})},
                       {10 * kMillisecond, writing(0x20, {2, 0x40})},
                       {20 * kMillisecond, reading(0x20, 9, 2)},
                       {30 * kMillisecond, writing(0x20, {4, 4})}};
    for (const Time begin : {0, 10, 20}) {
        bus.faults.push_back(fault("sda"));
        bus.faults.back().begin = begin * kMillisecond + (begin == 20 ? 40 : 18) * kClock;
        if (begin == 0) bus.faults.back().begin += kMillisecond;
        bus.faults.back().set("time", seconds(8 * kClock + kClock / 2));  // of the last byte
    }
    bus.run();
    REQUIRE(bus.linux_results.size() == 4);
    CHECK(bus.linux_results[0].error == 0);
    CHECK(bus.boards[0].seen.at(1) == 0);
    CHECK(bus.linux_results[1].error == EAGAIN);
    CHECK(bus.linux_results[2].error == 0);
    CHECK(static_cast<std::uint8_t>(bus.linux_results[2].data.at(1)) != 0xFF);
    CHECK(bus.linux_results[3].error == 0);
    CHECK(bus.boards[0].seen.at(4) == 4);
}

TEST_CASE("lose_arbitration: EAGAIN, the bus is busy for the time given, then free again") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        INFO("seed " << seed);
        Draw draw(seed);
        const Time busy = draw.time(kMillisecond, 3 * kMillisecond);
        SharedBus bus = writes(0x20, 3, 3);
        bus.faults = {fault("lose_arbitration", {.position = static_cast<int>(draw.below(2) * 2)})};
        bus.faults[0].count = 1;
        bus.faults[0].skip = 1;
        bus.faults[0].set("time", seconds(busy));
        bus.pic = {{6 * kMillisecond + 40 * kClock, writing(0x20, {9, 9})},
                   {6 * kMillisecond + 40 * kClock + busy, writing(0x20, {8, 8})}};
        bus.run();
        REQUIRE(bus.linux_results.size() == 3);
        CHECK(bus.linux_results[0].error == 0);
        CHECK(bus.linux_results[1].error == EAGAIN);
        CHECK(bus.linux_results[2].error == 0);
        REQUIRE(bus.pic_results.size() == 2);
        CHECK(bus.pic_results[0].error == EAGAIN);
        CHECK(bus.pic_results[1].error == 0);
        CHECK(bus.boards[0].seen.at(8) == 8);
    }
    SharedBus bus = writes(0x01, 3, 3);  // address byte 0x02: nobody can win from a 0
    bus.faults = {fault("lose_arbitration", {.phase = "address"})};
    bus.faults[0].set("bit", 7);
    bus.faults[0].set("time", seconds(kMillisecond));
    bus.run();
    CHECK(evidence(bus)[0]["fired"] == 0);
    CHECK(bus.linux_results[1].error == 0);
}

TEST_CASE("a spurious STOP or START: what follows reaches nobody, or the wrong device") {
    Draw draw(Catch::rngSeed());
    const auto position = static_cast<int>(1 + draw.below(3));
    SharedBus bus = writes(0x20, 2, 4);
    bus.faults = {fault("stop", {.position = position})};
    bus.faults[0].count = 1;
    bus.run();
    CHECK(bus.linux_results[0].error == EREMOTEIO);
    CHECK(bus.linux_results[1].error == 0);
    CHECK(bus.boards[0].seen.size() == 1 + (position == 3 ? 1u : 0u));

    SharedBus start;
    start.boards = {{.address = 0x20}, {.address = 0x31}};
    start.linux_board = {{kMillisecond, writing(0x20, {1, 0x62, 5, 6})},
                         {5 * kMillisecond, writing(0x20, {3, 4})}};
    start.faults = {fault("start", {.position = 2})};
    start.faults[0].count = 1;
    start.run();  // 0x62: a write to 0x31
    CHECK(start.linux_results[0].error == 0);
    CHECK(start.boards[1].seen.at(5) == 6);
    CHECK(start.boards[0].seen.at(3) == 4);
    start.linux_board[0] = {kMillisecond, reading(0x20, 5, 2)};
    start.faults[0] = fault("start", {.position = 2, .phase = "read"});
    start.run();
    CHECK(start.linux_results[0].error == 0);
    CHECK(static_cast<std::uint8_t>(start.linux_results[0].data.at(0)) == 0x5A);
    CHECK(static_cast<std::uint8_t>(start.linux_results[0].data.at(1)) == 0xFF);
}

TEST_CASE("incomplete_address_phase and incomplete_write_byte: Linux recovers the bus") {
    for (const char* const kind : {"incomplete_address_phase", "incomplete_write_byte"}) {
        for (unsigned seed = 1; seed <= 3; ++seed) {
            INFO("seed " << seed << " " << kind);
            Draw draw(seed);
            SharedBus bus;
            bus.ground_sensor = true;
            bus.boards.push_back({.address = 0x20});
            const bool inside = draw.below(2) == 1;
            const Time begin = draw.time(3 * kMillisecond, 4 * kMillisecond);
            bus.faults = {fault(kind, {.address = inside ? 0x60 : 0x20})};
            bus.faults[0].begin = begin;
            bus.linux_board = {{kMillisecond, writing(0x20, {1, 2})},
                               {8 * kMillisecond, writing(0x20, {3, 4})}};
            bus.pic = {{6 * kMillisecond, writing(0x20, {5, 6})}, {10 * kMillisecond, writing(0x20, {7, 8})}};
            bus.run();
            CHECK(bus.linux_results[0].error == 0);
            CHECK(bus.pic_results[0].error == EAGAIN);  // a dsPIC cannot recover it
            CHECK(bus.linux_results[1].error == 0);
            CHECK(bus.linux_results[1].time >= 8 * kMillisecond + 10 * kClock + 28 * kClock);
            CHECK(bus.pic_results[1].error == 0);
            CHECK(bus.boards[0].seen.size() == 3);  // 0x00 is the register's number; nothing is written
            CHECK(evidence(bus)[0]["fired"] == 1);
            CHECK(evidence(bus)[0]["firings"][0][0].get<double>() * 1e-12 ==
                  Approx(static_cast<double>(begin) * 1e-12));
        }
    }
    SharedBus nobody = writes(0x20, 2, 2);  // an address at which nobody pulls SDA low
    nobody.faults = {fault("incomplete_address_phase", {.address = 0x33})};
    nobody.faults[0].begin = 4 * kMillisecond;
    nobody.run();
    CHECK(nobody.linux_results[1].error == 0);
}

TEST_CASE("slave_reset: nobody answers for the time given, then as after power-on") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        Draw draw(seed);
        INFO("seed " << seed);
        const auto position = static_cast<int>(draw.below(3));
        SharedBus bus = writes(0x20, 5, 3);
        bus.faults = {fault("slave_reset", {.position = position})};
        bus.faults[0].count = 1;
        bus.faults[0].skip = 1;
        bus.faults[0].set("time", seconds(draw.time(6 * kMillisecond, 9 * kMillisecond)));
        bus.run();
        REQUIRE(bus.linux_results.size() == 5);
        const std::vector<int> errors{0, EREMOTEIO, EREMOTEIO, 0, 0};
        for (std::size_t i = 0; i < 5; ++i)
            CHECK(bus.linux_results[i].error == errors[i]);
    }
    SharedBus sensor;  // its register pointer is 0 again
    sensor.ground_sensor = true;
    sensor.linux_board = {{kMillisecond, reading(0x60, 12)},
                          {2 * kMillisecond, writing(0x60, std::string(1, '\x0C'))},
                          {3 * kMillisecond, writing(0x60, std::string(1, '\x0C'))},
                          {5 * kMillisecond, {0, {{0x60, true, false, {}, 1}}, kSecond}}};
    sensor.faults = {fault("slave_reset", {.phase = "write"})};
    sensor.faults[0].skip = 2;
    sensor.faults[0].set("time", seconds(kMillisecond));
    sensor.run();
    CHECK(sensor.linux_results[0].data == "\x01");
    CHECK(sensor.linux_results[2].error == EREMOTEIO);
    CHECK(sensor.linux_results[3].data == std::string(1, '\0'));
}

TEST_CASE("clash: bytes read are the and of both devices, an absent device is acknowledged") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        Draw draw(seed);
        const std::uint8_t mine = draw.byte(), other = draw.byte();
        SharedBus bus;
        bus.boards.push_back({.address = 0x20, .fill = mine});
        bus.linux_board = {{kMillisecond, reading(0x20, 1, 3)}, {5 * kMillisecond, reading(0x40, 1)}};
        bus.faults = {fault("clash", {.address = 0x20}), fault("clash", {.address = 0x40})};
        bus.faults[0].set("value", other);
        bus.faults[1].set("value", other);
        bus.run();
        INFO("seed " << seed);
        for (const char byte : bus.linux_results[0].data)
            CHECK(static_cast<std::uint8_t>(byte) == (mine & other));
        CHECK(bus.linux_results[1].error == 0);
        CHECK(static_cast<std::uint8_t>(bus.linux_results[1].data.at(0)) == other);
    }
}

TEST_CASE("slow_rise: each clock takes so much longer") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        Draw draw(seed);
        const Time rise = draw.time(kMicrosecond, 20 * kMicrosecond);
        SharedBus plain = writes(0x20, 2, 3), slow = writes(0x20, 2, 3);
        slow.faults = {fault("slow_rise")};
        slow.faults[0].set("time", seconds(rise));
        plain.run();
        slow.run();
        INFO("seed " << seed << " rise " << rise);
        CHECK(slow.linux_results[0].error == 0);
        CHECK(slow.linux_results[0].time - plain.linux_results[0].time == 4 * 9 * rise);
        CHECK(slow.boards[0].seen == plain.boards[0].seen);
    }
}

TEST_CASE("probability: a drawn share suffers, the same in every run, and faults do not shift each other") {
    SharedBus bus;
    bus.boards.push_back({});
    bus.duration = 300 * kMillisecond;
    for (int i = 0; i < 250; ++i)
        bus.linux_board.push_back({(1 + i) * kMillisecond, writing(0x20, {1, 2})});
    bus.faults = {fault("nack", {.phase = "address"})};
    bus.faults[0].probability = 0.2;
    bus.run();
    const int alone = evidence(bus)[0]["fired"].get<int>();
    CHECK(alone > 50 - 4 * 7);  // four standard deviations
    CHECK(alone < 50 + 4 * 7);
    bus.faults.push_back(fault("stretch"));
    bus.faults[1].probability = 0.5;
    bus.faults[1].set("time", seconds(20 * kMicrosecond));
    bus.run();
    CHECK(evidence(bus)[0]["fired"] == alone);
    bus.seed = 2;
    bus.run();
    CHECK(evidence(bus)[0]["firings"].dump().size() > 0);
}

TEST_CASE("numbers that an I2C fault cannot have") {
    const auto refused = [](FaultSpec spec) {
        INFO(spec.kind);
        const KindInfo* kind = find_kind(spec.kind, PlaceKind::I2c);
        REQUIRE(kind != nullptr);
        const auto read = [&] {
            check_fault(spec, *kind);
            read_i2c_fault(spec);
        };
        CHECK_THROWS_AS(read(), InputError);
    };
    refused(fault("stretch"));                   // no time
    refused(fault("clash"));                     // no address
    refused(fault("incomplete_address_phase"));  // no address
    refused(fault("nack", {.address = 0x78}));   // reserved
    refused(fault("nack", {.phase = "read"}));   // the master's
    refused(fault("nack", {.phase = "some"}));
    refused(fault("stop", {.position = 0}));  // there is a START
    refused(fault("flip").set("bit", 8));
    refused(fault("flip", {.position = 0}).set("bit", 0.0));  // the direction
    refused(fault("slow_rise").set("time", 1.0));
    refused(fault("lose_arbitration", {.phase = "read"}).set("time", 0.001));
    SharedBus bus;
    bus.faults = {fault("nack", {.from = "robot0.nobody"})};
    CHECK_THROWS_AS(bus.run(), InputError);
}

TEST_CASE("every kind of the table is one that the bus knows") {
    int kinds = 0;
    for (const KindInfo& kind : all_kinds()) {
        if (kind.place != PlaceKind::I2c) continue;
        ++kinds;
        CHECK(i2c_fault_of_name(kind.name).has_value());
    }
    CHECK(kinds == 13);
}
