// The I2C bus: phase timing, absent devices, registers, arbitration, waiting, boards behind a port.

#include "base/error.h"
#include "base/fields/json.h"
#include "cosim/i2c/i2c_shared.h"
#include "emu/i2c_devices/bus_node.h"
#include "emu/i2c_devices/signals.h"
#include "physics/description/channels.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;
using i2c_devices::BusSpec;
using i2c_devices::make_bus_node;

namespace {

constexpr PortIndex kPic = 0, kLinux = 1;
constexpr Time kPeriod = 10 * kMicrosecond;  // 100 kHz
constexpr Time kSlow = 11'140'000;           // 89.8 kHz, the dsPIC's

/// Speaks to a bus node as one or more masters would, checking every EOT on the way.
class Bench {
  public:
    explicit Bench(BusSpec spec = {}) : node_(make_bus_node(spec)) {
        world = static_cast<PortIndex>(node_->ports().size() - 1);
    }

    void send(PortIndex port, I2cPhaseKind kind, std::uint8_t byte, Time start, Time period = kPeriod,
              bool ack = true) {
        I2cPhase phase{.kind = kind, .byte = byte, .ack = ack, .start = start, .clock_period = period};
        give({start, port, phase});
    }
    void give(const Message& message) { inbox_.push_back(message); }
    /// Everything that counts before `time`; the node may send it earlier.
    std::vector<Message> until(Time time) {
        std::stable_sort(inbox_.begin(), inbox_.end(),
                         [](const Message& a, const Message& b) { return a.time < b.time; });
        std::vector<Message> told;
        std::vector<Time> earliest;
        const Time first_in = inbox_.empty() ? kNever : inbox_.front().time;
        for (PortIndex p = 0; p <= world; ++p)
            earliest.push_back(std::min(node_->earliest_output(p), later(first_in, node_->lookahead(p))));
        node_->advance(time, inbox_, told);
        inbox_.clear();
        for (const auto& message : told) {
            CHECK(message.time >= earliest[message.port]);
            told_.push_back(message);
        }
        std::stable_sort(told_.begin(), told_.end(),
                         [](const Message& a, const Message& b) { return a.time < b.time; });
        const auto later_on = std::find_if(told_.begin(), told_.end(),
                                           [&](const Message& message) { return message.time >= time; });
        const std::vector<Message> out(told_.begin(), later_on);
        told_.erase(told_.begin(), later_on);
        for (PortIndex p = 0; p <= world; ++p)
            CHECK(node_->earliest_output(p) >= time);
        return out;
    }
    /// One phase and its answer; advances in small grants.
    I2cPhase ask(PortIndex port, I2cPhaseKind kind, std::uint8_t byte, Time start, Time period = kPeriod) {
        send(port, kind, byte, start, period);
        for (Time time = start + kMicrosecond;; time += 7 * kMicrosecond)
            for (const auto& message : until(time))
                if (message.port == port) {
                    now = message.time;
                    return std::get<I2cPhase>(message.payload);
                }
    }
    std::string report() { return node_->finish(); }

    PortIndex world = 0;
    Time now = 0;

  private:
    std::unique_ptr<Node> node_;
    std::vector<Message> inbox_;
    std::vector<Message> told_;  // and still to count
};

I2cPhase only(const std::vector<Message>& messages) {
    REQUIRE(messages.size() == 1);
    return std::get<I2cPhase>(messages[0].payload);
}

}  // namespace

TEST_CASE("an absent address is not acknowledged, at the ninth clock") {
    Bench bench;
    bench.send(kPic, I2cPhaseKind::Start, 0x40, kMillisecond, kSlow);
    CHECK(bench.until(kMillisecond + 9 * kSlow).empty());
    const auto out = bench.until(kMillisecond + 9 * kSlow + 1);
    CHECK(only(out).kind == I2cPhaseKind::Acknowledge);
    CHECK(only(out).ack == 0);
    CHECK(out[0].time == kMillisecond + 9 * kSlow);
    const auto data = bench.ask(kPic, I2cPhaseKind::Read, 0, 2 * kMillisecond, kSlow);
    CHECK(data.byte == 0xFF);
}

TEST_CASE("the ground sensor's registers, read as the Linux program does") {
    Bench bench;
    bench.give({1, bench.world, Signal{i2c_devices::kGroundReflected, 800}});
    bench.give({1, bench.world, Signal{i2c_devices::kGroundReflected + 2, 329.4}});
    bench.give({1, bench.world, Signal{i2c_devices::kGroundAmbient + 1, 30}});
    bench.until(kMillisecond);
    const auto read_register = [&](std::uint8_t number) {
        const Time begun = bench.now + kMillisecond;
        CHECK(bench.ask(kLinux, I2cPhaseKind::Start, 0xC0, begun).ack == 1);
        CHECK(bench.now == begun + 9 * kPeriod);
        CHECK(bench.ask(kLinux, I2cPhaseKind::Write, number, bench.now).ack == 1);
        bench.send(kLinux, I2cPhaseKind::Stop, 0, bench.now);
        CHECK(bench.ask(kLinux, I2cPhaseKind::Start, 0xC1, bench.now + kPeriod).ack == 1);
        const auto byte = bench.ask(kLinux, I2cPhaseKind::Read, 0, bench.now).byte;
        bench.send(kLinux, I2cPhaseKind::Stop, 0, bench.now);
        CHECK(bench.now - begun == 37 * kPeriod);  // four bytes and a stop
        return byte;
    };
    CHECK(read_register(0) == 0x03);
    CHECK(read_register(1) == 0x20);
    CHECK(read_register(2) == 0);
    CHECK(read_register(4) == 1);
    CHECK(read_register(5) == 329 - 256);
    CHECK(read_register(9) == 30);
    CHECK(read_register(12) == 1);
    CHECK(read_register(13) == 0);
}

TEST_CASE("registers count up over a longer read") {
    Bench bench;
    bench.give({1, bench.world, Signal{i2c_devices::kGroundReflected, 0x123}});
    bench.ask(kPic, I2cPhaseKind::Start, 0xC0, kMillisecond);
    bench.ask(kPic, I2cPhaseKind::Write, 0, bench.now);
    bench.ask(kPic, I2cPhaseKind::Start, 0xC1, bench.now);  // repeated start
    CHECK(bench.ask(kPic, I2cPhaseKind::Read, 0, bench.now).byte == 1);
    CHECK(bench.ask(kPic, I2cPhaseKind::Read, 0, bench.now).byte == 0x23);
}

TEST_CASE("the RGB turret takes nine bytes and shows them as signals") {
    Bench bench;
    const auto write = [&](int count) {
        bench.ask(kLinux, I2cPhaseKind::Start, 0xC2, bench.now + kMillisecond);
        for (int i = 0; i < count; ++i)
            CHECK(bench.ask(kLinux, I2cPhaseKind::Write, static_cast<std::uint8_t>(i), bench.now).ack == 1);
        bench.send(kLinux, I2cPhaseKind::Stop, 0, bench.now);
        return bench.until(bench.now + kMillisecond);
    };
    CHECK(write(8).empty());
    bench.now += kMillisecond;
    const auto shown = write(9);
    REQUIRE(shown.size() == 8);  // LED 2's red stays 0
    CHECK(shown[0].port == bench.world);
    CHECK(std::get<Signal>(shown[0].payload) == Signal{i2c_devices::kRgb + 7, 1});  // LED 2 green
    CHECK(std::get<Signal>(shown[7].payload) == Signal{i2c_devices::kRgb + 2, 8});  // LED 0 blue
    CHECK(bench.report().find(R"("frames":1,"wrong_length":1)") != std::string::npos);
}

TEST_CASE("of two starts at once the lower address wins, the other hears that it lost") {
    const PortIndex low = GENERATE(kPic, kLinux);
    Bench bench;
    bench.send(low, I2cPhaseKind::Start, 0xC0, kMillisecond + 2 * kMicrosecond);
    bench.send(low == kPic ? kLinux : kPic, I2cPhaseKind::Start, 0xC2, kMillisecond);
    const auto out = bench.until(2 * kMillisecond);
    REQUIRE(out.size() == 2);
    for (const auto& message : out) {
        const auto& phase = std::get<I2cPhase>(message.payload);
        CHECK(phase.kind == (message.port == low ? I2cPhaseKind::Acknowledge : I2cPhaseKind::BusLost));
        CHECK(message.time == phase.start + 9 * kPeriod);
    }
    CHECK(bench.report().find(R"("lost":1)") != std::string::npos);
}

TEST_CASE("while one owns the bus the dsPIC loses and Linux waits for the stop") {
    Bench bench;
    bench.ask(kLinux, I2cPhaseKind::Start, 0xC0, kMillisecond);
    CHECK(bench.ask(kPic, I2cPhaseKind::Start, 0xC0, bench.now).kind == I2cPhaseKind::BusLost);
    bench.send(kPic, I2cPhaseKind::Stop, 0, bench.now);  // its attempt to tidy up disturbs nobody
    CHECK(bench.ask(kLinux, I2cPhaseKind::Write, 0, bench.now).ack == 1);
    bench.send(kLinux, I2cPhaseKind::Stop, 0, bench.now);
    CHECK(bench.ask(kPic, I2cPhaseKind::Start, 0xC0, bench.now + kMillisecond).ack == 1);
    const Time asked = bench.now;
    bench.send(kLinux, I2cPhaseKind::Start, 0xC2, asked);
    CHECK(bench.until(asked + kMillisecond).empty());
    bench.send(kPic, I2cPhaseKind::Stop, 0, asked + kMillisecond);
    const auto out = bench.until(asked + 2 * kMillisecond);
    CHECK(only(out).ack == 1);
    CHECK(out[0].port == kLinux);
    CHECK(out[0].time == asked + kMillisecond + 10 * kPeriod);  // bus free, then nine clocks
}

TEST_CASE("a board behind a port answers in its own time, the master sees the stretch") {
    Bench bench({.boards = {{"rab", 0x20}}});
    constexpr PortIndex kRab = 2;
    CHECK(bench.world == 3);
    bench.send(kLinux, I2cPhaseKind::Start, 0x40, kMillisecond);
    auto out = bench.until(kMillisecond + 8 * kPeriod);
    CHECK(only(out).kind == I2cPhaseKind::Start);
    CHECK(out[0].port == kRab);
    CHECK(out[0].time == kMillisecond + kPeriod / 2);  // distinguished from other masters
    const auto answer = [&](I2cPhaseKind kind, std::uint8_t byte, bool ack, Time time) {
        bench.give({time, kRab, I2cPhase{.kind = kind, .byte = byte, .ack = ack}});
        return bench.until(time + 5 * kPeriod);
    };
    out = answer(I2cPhaseKind::Acknowledge, 0, true, kMillisecond + 8 * kPeriod);
    CHECK(only(out).ack == 1);
    CHECK(only(out).stretch == 0);
    CHECK(out[0].time == kMillisecond + 9 * kPeriod);
    bench.send(kLinux, I2cPhaseKind::Read, 0, 2 * kMillisecond);
    CHECK(only(bench.until(2 * kMillisecond + kPeriod)).kind == I2cPhaseKind::Read);
    out = answer(I2cPhaseKind::Data, 0x5A, true, 3 * kMillisecond);  // a slow interrupt routine
    CHECK(only(out).byte == 0x5A);
    CHECK(out[0].time == 3 * kMillisecond + kPeriod);
    CHECK(only(out).stretch == kMillisecond - 8 * kPeriod);
    bench.send(kLinux, I2cPhaseKind::Stop, 0, 4 * kMillisecond);
    out = bench.until(5 * kMillisecond);
    CHECK(only(out).kind == I2cPhaseKind::Stop);
    CHECK(out[0].port == kRab);
}

TEST_CASE("the log has first transfers, absent devices, lost buses and stretches") {
    const auto file = puckloop::tests::scratch_path("puckloop-i2c-log-test.log");
    const auto run = [&](Time longest) {
        Bench bench({.boards = {{"rab", 0x20}}, .log = file.string()});
        constexpr PortIndex kRab = 2;
        const auto wait = [&](Time end) {
            for (Time at = bench.now; at < end; at = std::min(at + longest, end))
                bench.until(std::min(at + longest, end));
            bench.now = end;
        };
        for (int i = 0; i < 5; ++i) {
            const Time begun = bench.now + kMillisecond;
            bench.send(kPic, I2cPhaseKind::Start, 0x90, begun);
            bench.send(kPic, I2cPhaseKind::Stop, 0, begun + 9 * kPeriod);
            wait(begun + kMillisecond);
        }
        bench.send(kLinux, I2cPhaseKind::Start, 0xC0, 20 * kMillisecond);
        bench.send(kPic, I2cPhaseKind::Start, 0xC3, 20 * kMillisecond + kPeriod);
        bench.send(kLinux, I2cPhaseKind::Stop, 0, 21 * kMillisecond);
        wait(22 * kMillisecond);
        bench.send(kLinux, I2cPhaseKind::Start, 0x41, 30 * kMillisecond);
        bench.give({31 * kMillisecond, kRab, I2cPhase{.kind = I2cPhaseKind::Acknowledge, .ack = 1}});
        wait(40 * kMillisecond);
        bench.report();
        std::ostringstream text;
        text << std::ifstream(file).rdbuf();
        std::filesystem::remove(file);
        return text.str();
    };
    const std::string log = run(kMillisecond);
    for (const char* line : {
             "[    0.000000 s] bus at 100 kHz; masters pic, linux; devices ",
             "s] pic: first transfer with 0x48, a write\n",
             "s] pic: nobody acknowledges 0x48\n",
             "s] pic: nobody acknowledges 0x48 (4 times so far)\n",
             "[    0.020010 s] pic: loses the bus, START for 0x61\n",
             "[    0.030005 s] linux: first transfer with 0x20, a read\n",
             "[    0.031000 s] linux: 0x20 stretches the clock by 920.000 us\n",
             "[    0.040000 s] pic with 0x48: 5 transfers, 5 not acknowledged\n",
             "[    0.040000 s] end: 7 transfers, ",
         })
        CHECK_THAT(log, Catch::Contains(line));
    CHECK_THAT(log, !Catch::Contains("(3 times"));
    CHECK(run(3 * kMicrosecond) == log);
}

TEST_CASE("descriptions of a bus are checked") {
    CHECK_THROWS_AS(make_bus_node(BusSpec{.hertz = 10}), InputError);
    CHECK_THROWS_AS(make_bus_node(BusSpec{.boards = {{"x", 0x78}}}), InputError);
    BusSpec spec;
    CHECK_THROWS_WITH(from_value(spec, parse_json(R"({"hertz":"fast"})"), "i2c_bus"),
                      Catch::StartsWith("i2c_bus.hertz: has the wrong type"));
    CHECK_THROWS_WITH(from_value(spec, parse_json(R"({"hertz":10})"), "i2c_bus"),
                      "i2c_bus.hertz: must be 1000 to 3.4e+06 Hz");
    BusSpec good;
    from_value(good, parse_json(R"({"name":"e1.i2c","rgb_turret":false})"), "i2c_bus");
    CHECK(make_bus_node(good)->name() == "e1.i2c");
}

TEST_CASE("the world publishes what the ground sensor listens to") {
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(i2c_devices::signals()[i2c_devices::kGroundReflected + i].name ==
              physics::channel_name(physics::kGroundChannel + i));
        CHECK(i2c_devices::signals()[i2c_devices::kGroundAmbient + i].name ==
              physics::channel_name(physics::kGroundAmbientChannel + i));
    }
    CHECK(i2c_devices::signals().size() == i2c_devices::kSignalCount);
}

TEST_CASE("a STOP behind an acknowledge meets the first bit of what the device sends next") {
    Bench bench;
    bench.give({1, bench.world, Signal{i2c_devices::kGroundReflected, 255}});  // 0x00, 0xFF
    const auto read_one = [&](Time start) {
        bench.ask(kPic, I2cPhaseKind::Start, 0xC0, start);
        bench.ask(kPic, I2cPhaseKind::Write, 0, bench.now);
        CHECK(bench.ask(kPic, I2cPhaseKind::Start, 0xC1, bench.now).ack == 1);
    };
    const auto ask_first_bit = [&] {
        bench.send(kPic, I2cPhaseKind::Acknowledge, 0, bench.now, kPeriod, kNoByteFollows != 0);
        const Time asked = bench.now;
        for (Time time = asked + kMicrosecond;; time += 7 * kMicrosecond)
            for (const auto& message : bench.until(time))
                if (message.port == kPic) {
                    bench.now = message.time;
                    CHECK(message.time == asked + 9 * kPeriod);
                    return std::get<I2cPhase>(message.payload);
                }
    };
    read_one(kMillisecond);
    CHECK(bench.ask(kPic, I2cPhaseKind::Read, 0, bench.now).byte == 0x00);
    const I2cPhase high = ask_first_bit();  // of 0xFF
    CHECK(high.kind == I2cPhaseKind::Acknowledge);
    CHECK(high.ack == 0);
    bench.send(kPic, I2cPhaseKind::Stop, 0, bench.now);
    read_one(3 * kMillisecond);                            // the bus is free again
    CHECK(ask_first_bit().kind == I2cPhaseKind::BusLost);  // of 0x00, right behind the address
    CHECK(bench.ask(kPic, I2cPhaseKind::Start, 0xC0, 5 * kMillisecond).kind == I2cPhaseKind::BusLost);
    // A driver's nine clocks and a STOP free it.
    CHECK(bench.ask(kLinux, I2cPhaseKind::Start, 0xC0, 6 * kMillisecond).ack == 1);
}

TEST_CASE("clocks out of step reach a device that receives as the bits that they are") {
    Bench bench;
    const auto loose = [&](int before, int count, std::uint8_t bits) {
        I2cPhase phase{.kind = I2cPhaseKind::Data,
                       .byte = bits,
                       .ack = LooseClocks{before, count}.packed(),
                       .start = bench.now,
                       .clock_period = kPeriod};
        bench.give({bench.now, kPic, phase});
        for (Time time = bench.now + kMicrosecond;; time += 7 * kMicrosecond)
            for (const auto& message : bench.until(time))
                if (message.port == kPic) {
                    bench.now = message.time;
                    return std::get<I2cPhase>(message.payload);
                }
    };
    CHECK(bench.ask(kPic, I2cPhaseKind::Start, 0xC0, kMillisecond).ack == 1);
    CHECK(bench.ask(kPic, I2cPhaseKind::Read, 0, bench.now).ack == kDeviceAcknowledges);
    // Its acknowledge, seven ones; one more; its acknowledge, seven ones ...
    I2cPhase line = loose(8, 8, 0xFF);
    CHECK(line.byte == 0x7F);
    CHECK(line.ack == 0);
    line = loose(7, 1, 0xFF);
    CHECK(line.ack == LooseClocks::kHeldLow);
    line = loose(8, 9, 0x00);  // no collision: a 0 in the device's acknowledge; then its byte of seven 0s, 1
    CHECK(line.byte == 0x00);
    CHECK(line.ack == LooseClocks::kHeldLow);
    line = loose(8, 8, 0xFF);
    CHECK(line.byte == 0x7F);
    line = loose(7, 8, 0xFF);  // a one, the acknowledge, six ones
    CHECK(line.byte == 0xBF);
    line = loose(6, 9, 0xC0);  // two ones, and the device acknowledges against the master's 0
    CHECK(line.byte == 0xC0);
    CHECK(line.ack == 0);
    loose(6, 8, 0xFF);
    line = loose(5, 9, 0xFF);  // three ones, and the acknowledge against a 1
    CHECK(line.kind == I2cPhaseKind::BusLost);
}
