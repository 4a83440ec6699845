#include "emu/rab_board/i2c_watch.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace puckloop;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

struct Watched {
    std::vector<std::string> lines;
    rab::I2cWatch watch{[this](Time, std::string text) { lines.push_back(std::move(text)); }};
    Time now = 0;

    void exchange(I2cPhaseKind kind, std::uint8_t byte, std::uint8_t ack = 1, Time stretch = 0) {
        I2cPhase phase{kind, byte, 0, now, 10 * cosim::kMicrosecond, 0};
        watch.phase(phase, now);
        now += 100 * cosim::kMicrosecond + stretch;
        phase.kind = kind == I2cPhaseKind::Read ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge;
        phase.ack = ack;
        phase.stretch = stretch;
        watch.answer(phase, now);
    }
    void write(std::uint8_t number, std::uint8_t value, Time stretch = 0) {
        exchange(I2cPhaseKind::Start, 0x40);
        exchange(I2cPhaseKind::Write, number);
        exchange(I2cPhaseKind::Write, value, 1, stretch);
    }
    void read(std::uint8_t number, std::vector<std::uint8_t> values) {
        exchange(I2cPhaseKind::Start, 0x40);
        exchange(I2cPhaseKind::Write, number);
        exchange(I2cPhaseKind::Start, 0x41);
        for (const std::uint8_t value : values)
            exchange(I2cPhaseKind::Read, value);
    }
};

}  // namespace

TEST_CASE("what the firmware ignores without a word is reported by the watch") {
    Watched w;
    w.write(21, 7);
    REQUIRE(w.lines ==
            std::vector<std::string>{"i2c: payload size 7 asked for, which is none of 8, 16, 24 or 32"});
    w.write(21, 24);
    CHECK(w.lines.back() == "i2c: payload size 24 bits asked for");
    w.write(30, 0xAB);
    CHECK(w.lines.back() == "i2c: write of 0xab to register 30, which is read only");
    w.write(99, 1);
    CHECK(w.lines.back() == "i2c: write of 0x01 to register 99, which does not exist");
    w.read(99, {0});
    CHECK(w.lines.back() == "i2c: read of register 99, which does not exist: 0x00");
    w.read(13, {0});
    CHECK(w.lines.back() == "i2c: read of register 13, which is write only: 0x00");
    const std::size_t told = w.lines.size();
    w.write(12, 0x64);
    w.write(14, 0x12);
    w.read(1, {1, 2});
    w.read(46, {3});
    CHECK(w.lines.size() == told);
    const rab::I2cCounters& counters = w.watch.counters();
    CHECK(counters.bad_sizes == 1);
    CHECK(counters.read_only_writes == 1);
    CHECK(counters.unknown_writes == 1);
    CHECK(counters.unknown_reads == 2);
    CHECK(counters.sends == 1);
    CHECK(counters.transfers == 14);
    CHECK(counters.bytes_read == 5);
}

TEST_CASE("polls that found a message are counted apart from those that did not") {
    Watched w;
    w.read(0, {0});
    w.read(0, {1});
    w.read(0, {0});
    CHECK(w.watch.counters().messages == 1);
    CHECK(w.watch.counters().empty_polls == 2);
}

TEST_CASE("stretched time is summed, long stretches are reported at powers of two") {
    Watched w;
    for (int i = 0; i < 5; ++i)
        w.write(14, 0x34, 808 * cosim::kMicrosecond);
    w.write(12, 0, 28 * cosim::kMicrosecond);
    CHECK(w.watch.counters().stretched == (5 * 808 + 28) * cosim::kMicrosecond);
    CHECK(w.watch.counters().longest_stretch == 808 * cosim::kMicrosecond);
    CHECK(w.lines ==
          std::vector<std::string>{"i2c: SCL held for 0.808 ms after 0x34 for register 14, 1 so far",
                                   "i2c: SCL held for 0.808 ms after 0x34 for register 14, 2 so far",
                                   "i2c: SCL held for 0.808 ms after 0x34 for register 14, 4 so far"});
}

TEST_CASE("a board that does not answer is reported, a Start for another board is not its business") {
    Watched w;
    w.exchange(I2cPhaseKind::Start, 0x40, 0);
    CHECK(w.lines == std::vector<std::string>{"i2c: address not acknowledged, 1 so far"});
    w.exchange(I2cPhaseKind::Start, 0xC0, 0);
    CHECK(w.lines.size() == 1);
    CHECK(w.watch.counters().transfers == 1);
    CHECK(w.watch.counters().not_acknowledged == 1);
}
