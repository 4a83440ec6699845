// The project's own e-puck firmware on the emulated board: firmware/epuck/README.md, line by line.

#include "protocols/serial/epuck_serial.h"
#include "tests/exec/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::protocols;
using exec::Rig;
using Bytes = std::vector<std::uint8_t>;

namespace {

const std::string kHex = std::string(PUCKLOOP_FIRMWARE) + "/epuck/epuck.hex";
const std::string kElf = std::string(PUCKLOOP_FIRMWARE) + "/epuck/epuck.elf";
const Bytes kHello{0x01, 0, 0, 0, 0};
constexpr double kReady = 0.03;   // s: reset to waiting
constexpr double kWire = 0.0105;  // s: 12 bytes, the answer of 72, and a little

Bytes actuators(int left, int right, std::uint8_t ring = 0, std::uint8_t others = 0,
                std::uint8_t reset = kEpuckContinue) {
    EpuckActuators a;
    a.left = static_cast<std::int16_t>(left);
    a.right = static_cast<std::int16_t>(right);
    a.ring_leds = ring;
    a.other_leds = others;
    a.reset = reset;
    const EpuckActuatorBytes bytes = encode(a);
    return {bytes.begin(), bytes.end()};
}

/// What comes back within `seconds`, as bytes.
Bytes ask(Rig& rig, const Bytes& bytes, double seconds = kWire) {
    rig.take(2);
    rig.send(2, bytes);
    rig.run_for(seconds);
    return rig.take_bytes(2);
}

EpuckSensors sensors_of(const Bytes& answer) {
    REQUIRE(answer.size() == kEpuckSensorBytes);
    return decode_sensors(std::span<const std::uint8_t, kEpuckSensorBytes>(answer.data(), kEpuckSensorBytes));
}

/// Ready and inside a session.
struct InSession {
    InSession() : rig("pic", kHex) {
        rig.run_to(kReady);
        REQUIRE(ask(rig, kHello).size() == kEpuckSensorBytes);
    }
    Rig rig;
};

double speed_over(Rig& rig, const std::string& wheel, double seconds) {
    const double before = rig.get(wheel);
    rig.run_for(seconds);
    return (rig.get(wheel) - before) / seconds;
}

}  // namespace

TEST_CASE("own firmware: ready within 30 ms of power-up, silent until woken, then one record") {
    Rig rig("pic", kHex);
    rig.run_to(kReady);
    CHECK(rig.take(2).empty());
    const EpuckSensors s = sensors_of(ask(rig, kHello));
    CHECK(why_implausible(s).empty());
    CHECK(s.battery_ok == 1);
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(s.light[i] == Approx(3800).margin(8));
        CHECK(s.proximity[i] == Approx(0).margin(8));
    }
    CHECK(rig.take(1).empty());
    CHECK(rig.chip().report().traps.empty());
    CHECK(rig.chip().report().resets.size() == 1);
}

TEST_CASE("own firmware: the ELF file is the same program") {
    Rig rig("pic", kElf);
    rig.run_to(kReady);
    CHECK(ask(rig, kHello).size() == kEpuckSensorBytes);
}

TEST_CASE("own firmware: wheels at the commanded speed, both directions, clamped, stopped") {
    InSession session;
    Rig& rig = session.rig;
    for (const int speed : {1000, 500, 384, 77, -500, -1000}) {
        CHECK(ask(rig, actuators(speed, -speed)).size() == kEpuckSensorBytes);
        rig.run_for(0.03);
        INFO(speed);
        CHECK(speed_over(rig, "wheel_left", 0.9) == Approx(speed).epsilon(0.005).margin(1.2));
        CHECK(ask(rig, actuators(speed, -speed)).size() == kEpuckSensorBytes);
        CHECK(speed_over(rig, "wheel_right", 0.9) == Approx(-speed).epsilon(0.005).margin(1.2));
    }
    ask(rig, actuators(30000, -30000));
    CHECK(speed_over(rig, "wheel_left", 0.5) == Approx(1001.7).margin(3));
    ask(rig, actuators(2, 3));
    CHECK(speed_over(rig, "wheel_left", 0.9) < 5);
    ask(rig, actuators(0, 0));
    CHECK(speed_over(rig, "wheel_left", 0.5) == 0);
    CHECK((rig.chip().peek("LATD") & 0xFF) == 0);  // no current
}

TEST_CASE("own firmware: a stream of changing speeds does not hold the wheels still") {
    InSession session;
    Rig& rig = session.rig;
    const double before = rig.get("wheel_left");
    for (int i = 0; i < 100; ++i)
        ask(rig, actuators(60 + i % 2, 60));  // a step takes 16 ms, commands come each 10.5 ms
    CHECK((rig.get("wheel_left") - before) / (100 * kWire) == Approx(60.5).margin(2));
}

TEST_CASE("own firmware: LEDs are set, not toggled") {
    InSession session;
    Rig& rig = session.rig;
    for (int repeat = 0; repeat < 2; ++repeat) {
        ask(rig, actuators(0, 0, 0xA5, 0x01));
        for (int led = 0; led < 8; ++led)
            CHECK(rig.get("led" + std::to_string(led)) == (0xA5 >> led & 1));
        CHECK(rig.get("led_front") == 1);
        CHECK(rig.get("led_body") == 0);
    }
    ask(rig, actuators(0, 0, 0, 0x02));
    CHECK(rig.get("led0") == 0);
    CHECK(rig.get("led_front") == 0);
    CHECK(rig.get("led_body") == 1);
}

TEST_CASE("own firmware: each sensor in its place, fresh within 30 ms") {
    InSession session;
    Rig& rig = session.rig;
    for (int i = 0; i < 8; ++i) {
        rig.set("proximity" + std::to_string(i), 200 + 100 * i);
        rig.set("ambient" + std::to_string(i), 3000 + 50 * i);
    }
    rig.set("battery_v", 3.2);
    rig.run_for(0.03);
    const EpuckSensors s = sensors_of(ask(rig, actuators(0, 0)));
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(s.proximity[i] == Approx(200 + 100 * static_cast<int>(i)).margin(8));
        CHECK(s.light[i] == Approx(3000 + 50 * static_cast<int>(i)).margin(8));
    }
    CHECK(s.battery_ok == 0);
}

TEST_CASE("own firmware: the accelerometer's axes are raw counts of the newest scan") {
    InSession session;
    Rig& rig = session.rig;
    CHECK(sensors_of(ask(rig, actuators(0, 0))).accelerometer ==
          std::array<std::int16_t, 3>{2048, 2048, 2848});
    rig.set("acc_x", 1892);
    rig.set("acc_y", 2206);
    rig.set("acc_z", 2800);
    rig.run_for(0.0003);  // two scans
    CHECK(sensors_of(ask(rig, actuators(0, 0))).accelerometer ==
          std::array<std::int16_t, 3>{1892, 2206, 2800});
}

TEST_CASE("own firmware: a volume is largest minus smallest of the last window, each microphone its own") {
    InSession session;
    Rig& rig = session.rig;
    rig.run_for(0.03);
    CHECK(sensors_of(ask(rig, actuators(0, 0))).microphones == std::array<std::int16_t, 4>{});
    for (int i = 0; i < 40; ++i) {
        const int sign = i % 2 == 0 ? 1 : -1;
        rig.set("mic0", 2048 + 150 * sign);
        rig.set("mic1", 2000 + 30 * sign);
        rig.set("mic2", 2048 + (i % 2) * 2047);
        rig.run_for(0.001);
    }
    rig.send(2, actuators(0, 0));
    rig.run_for(0.0013);  // the record is there, the answer begun
    rig.set("mic0", 2048);
    const EpuckSensors s = sensors_of((rig.run_for(kWire), rig.take_bytes(2)));
    CHECK(s.microphones == std::array<std::int16_t, 4>{300, 60, 2047, 0});
    for (const char* mic : {"mic1", "mic2"})
        rig.set(mic, 2048);
    rig.run_for(0.029);  // two windows of 14.24 ms
    CHECK(sensors_of(ask(rig, actuators(0, 0))).microphones == std::array<std::int16_t, 4>{});
}

TEST_CASE("own firmware: a sound's level comes out as volume") {
    InSession session;
    Rig& rig = session.rig;
    rig.set("mic_level1", 400);
    rig.run_for(0.03);
    double sum = 0.0;
    constexpr int kWindows = 60;  // each scatters by 12 %: their mean by 6 counts
    for (int i = 0; i < kWindows; ++i) {
        rig.run_for(0.01);
        const EpuckSensors s = sensors_of(ask(rig, actuators(0, 0)));
        sum += s.microphones[1];
        CHECK(s.microphones[0] == 0);
    }
    CHECK(sum / kWindows == Approx(400).margin(20));
}

TEST_CASE("own firmware: the emitters are pulsed in turn, 284.8 us each 13.10 ms") {
    InSession session;
    Rig& rig = session.rig;
    rig.clear_changes();
    rig.run_for(1.0);
    for (const char* pulse : {"pulse0", "pulse1", "pulse2", "pulse3"}) {
        const auto changes = rig.changes(pulse);
        REQUIRE(changes.size() > 150);
        for (std::size_t i = changes[0].value == 1 ? 0 : 1; i + 2 < changes.size(); i += 2) {
            CHECK(changes[i + 1].time_s - changes[i].time_s == Approx(284.8e-6).margin(3e-6));
            CHECK(changes[i + 2].time_s - changes[i].time_s == Approx(13.10e-3).margin(5e-6));
        }
    }
}

TEST_CASE("own firmware: wheels stop a second after the last command, and go on with the next") {
    InSession session;
    Rig& rig = session.rig;
    ask(rig, actuators(400, 400));
    rig.run_for(0.9);
    CHECK(speed_over(rig, "wheel_left", 0.05) > 300);
    rig.run_for(0.1);
    CHECK(speed_over(rig, "wheel_left", 0.5) == 0);
    CHECK(ask(rig, actuators(400, 400)).size() == kEpuckSensorBytes);
    CHECK(speed_over(rig, "wheel_left", 0.5) == Approx(400).margin(4));
}

TEST_CASE("own firmware: the end record stops all, unanswered, the next session begins") {
    InSession session;
    Rig& rig = session.rig;
    ask(rig, actuators(400, 400, 0xFF, 3));
    CHECK(ask(rig, actuators(0, 0, 0, 0, kEpuckEnd), 0.1).empty());
    CHECK(speed_over(rig, "wheel_left", 0.5) == 0);
    CHECK(rig.get("led_body") == 0);
    rig.clear_changes();
    rig.run_for(8.0);  // blinks: each ring LED once
    for (int led = 0; led < 8; ++led)
        CHECK_FALSE(rig.changes("led" + std::to_string(led)).empty());
    CHECK(ask(rig, kHello).size() == kEpuckSensorBytes);
}

TEST_CASE("own firmware: any byte wakes it, and a lone one is forgotten") {
    Rig rig("pic", kHex);
    rig.run_to(kReady);
    CHECK(ask(rig, {0x77}, 0.1).empty());
    CHECK(ask(rig, {0x42, 0xFF, 0xFF, 0xFF, 0xFF}).size() == kEpuckSensorBytes);
}

TEST_CASE("own firmware: part of a record is dropped and answered, not obeyed, the next record counts") {
    for (std::size_t part = 1; part < kEpuckActuatorBytes; ++part) {
        InSession session;
        Rig& rig = session.rig;
        ask(rig, actuators(300, 300));
        Bytes record = actuators(-900, -900, 0xFF);
        record.resize(part);
        INFO(part);
        CHECK(ask(rig, record, 0.018).empty());
        rig.run_for(0.015);
        CHECK(rig.take(2).size() == kEpuckSensorBytes);
        CHECK(rig.get("led0") == 0);
        CHECK(ask(rig, actuators(300, 300, 0x01)).size() == kEpuckSensorBytes);
        CHECK(rig.get("led0") == 1);
        CHECK(speed_over(rig, "wheel_left", 0.2) == Approx(300).margin(10));
    }
}

TEST_CASE("own firmware: a program started anew in mid-session gets its first record, the wheels stop") {
    InSession session;
    Rig& rig = session.rig;
    ask(rig, actuators(300, 300, 0xFF));
    CHECK(ask(rig, kHello, 0.04).size() == kEpuckSensorBytes);
    CHECK(rig.get("led0") == 0);
    CHECK(speed_over(rig, "wheel_left", 0.2) == 0);
    CHECK(ask(rig, actuators(300, 300)).size() == kEpuckSensorBytes);
}

TEST_CASE("own firmware: a record with a framing error is answered and not obeyed") {
    InSession session;
    Rig& rig = session.rig;
    ask(rig, actuators(200, 200));
    const Bytes record = actuators(-900, -900, 0x01);
    rig.send(2, {record.begin(), record.begin() + 6});
    rig.run_for(0.001);
    cosim::UartFrame bad;
    bad.bit_period = cosim::from_seconds(1.0 / 115200);
    bad.start = rig.bench().now() - 9 * bad.bit_period;
    bad.data = 0;
    bad.is_break = 1;
    rig.chip().uart_receive(2, bad);
    rig.run_for(0.0005);
    CHECK(ask(rig, {record.begin() + 7, record.end()}).size() == kEpuckSensorBytes);
    CHECK(rig.get("led0") == 0);
    CHECK(speed_over(rig, "wheel_left", 0.3) == Approx(200).margin(8));
}

TEST_CASE("own firmware: after a reset that is not power-up it speaks first, for a program left waiting") {
    InSession session;
    Rig& rig = session.rig;
    ask(rig, actuators(300, 300));
    rig.send(2, {actuators(300, 300)});
    rig.run_for(0.0004);
    rig.take(2);
    rig.chip().mclr();
    rig.run_for(0.05);
    CHECK(rig.take(2).size() == kEpuckSensorBytes);
    CHECK(speed_over(rig, "wheel_left", 0.2) == 0);
    // The program that was waiting goes on as if nothing had been.
    CHECK(ask(rig, actuators(300, 300), 0.05).size() == kEpuckSensorBytes);
    CHECK(speed_over(rig, "wheel_left", 0.3) == Approx(300).margin(8));

    // A program that starts only now begins a session as ever.
    rig.chip().mclr();
    rig.run_for(0.5);
    rig.take(2);
    CHECK(ask(rig, kHello, 0.05).size() == kEpuckSensorBytes);
    CHECK(ask(rig, actuators(300, 300), 0.05).size() == kEpuckSensorBytes);
}

TEST_CASE("own firmware: no register without a model is touched, nothing traps") {
    InSession session;
    Rig& rig = session.rig;
    for (int i = 0; i < 20; ++i)
        ask(rig, actuators(i * 100 - 1000, 500, static_cast<std::uint8_t>(i)), 0.1);
    const auto report = rig.chip().report();
    CHECK(report.unmodelled.empty());
    CHECK(report.traps.empty());
    CHECK(report.resets.size() == 1);
}
