// IRcom with the project's own images: robots with epuck_ircom.hex, booths with the project's TAM firmware,
// among themselves and with the original images where those are at hand. Words and places are drawn at
// random.

#include "tests/ircom/air.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::ircom_test;
using protocols::EpuckSensors;

namespace {

const std::string kOwn = std::string(PUCKLOOP_FIRMWARE) + "/epuck/epuck_ircom.hex";
const std::string kOwnTam = TAM_FIRMWARE;
constexpr Time kCycle = 100 * kMillisecond;

void begin_sessions(Air& air) {
    for (Robot* robot : air.robots)
        robot->send(air.now, {1, 0, 0, 0, 0});
    air.run_for(300 * kMillisecond);
    for (Robot* robot : air.robots) {
        REQUIRE(robot->received.size() == 72);
        robot->received.clear();
    }
}

EpuckSensors take_record(Robot& robot) {
    REQUIRE(robot.received.size() == 72);
    const auto sensors =
        protocols::decode_sensors(std::span<const std::uint8_t, 72>(robot.received.data(), 72));
    robot.received.clear();
    CHECK(protocols::why_implausible(sensors).empty());
    return sensors;
}

/// A robot in a booth: how many of `rounds` words each side has got within two seconds.
void check_booth(const std::string& robot_image, const std::string& booth_image, int rounds,
                 std::uint64_t seed) {
    RandomStream random(seed, "own booth");
    auto description = world();
    const double heading = 2 * std::numbers::pi * random.uniform();
    add_robot(description, "robot0", 0.1, 0.2, heading + std::numbers::pi + 0.3 * (random.uniform() - 0.5));
    add_booth(description, "tam0", 0.1, 0.2, heading);
    Robot robot("robot0", robot_image, -18.0);
    tam::test::Booth booth(booth_image);
    booth.rig.board.set_signal(tam::kBarrier + 1, 1.0);
    Air air(description);
    air.robots = {&robot};
    air.booths = {&booth};
    air.boot(4 * kSecond);
    begin_sessions(air);
    for (int round = 0; round < rounds; ++round) {
        const auto from_robot = static_cast<std::uint8_t>(1 + random.below(255));
        const auto from_booth = static_cast<std::uint8_t>(1 + random.below(255));
        CAPTURE(round, int{from_robot}, int{from_booth});
        booth.command({0x0C, from_booth});
        bool robot_heard = false, booth_heard = false;
        const std::size_t reports = booth.reports().size();
        for (int cycle = 0; cycle < 20 && !(robot_heard && booth_heard); ++cycle) {
            // Every third record carries a word: who talks all the time hears nothing.
            robot.send_word(air.now, cycle % 3 == 0 ? from_robot : -1);
            air.run_for(kCycle);
            const EpuckSensors sensors = take_record(robot);
            if (sensors.ircom_received == 1 && sensors.ircom_data == from_booth) {
                robot_heard = true;
                CHECK((sensors.ircom_sensor == 1 || sensors.ircom_sensor == 2));
            }
            const auto all = booth.reports();
            for (std::size_t i = reports; i < all.size(); ++i)
                booth_heard |= all[i].second.back() == from_robot;
        }
        CHECK(robot_heard);
        CHECK(booth_heard);
    }
}

}  // namespace

TEST_CASE("robots with the own firmware hear each other's words, from where and how far away") {
    RandomStream random(41, "own robots");
    for (int place = 0; place < 4; ++place) {
        const double distance = 0.08 + 0.12 * random.uniform();
        const double toward = 2 * std::numbers::pi * random.uniform();
        const double turned = 2 * std::numbers::pi * random.uniform();
        auto description = world();
        add_robot(description, "a", 0, 0, toward);
        add_robot(description, "b", distance * std::cos(toward), distance * std::sin(toward),
                  toward + std::numbers::pi + (place % 2 == 0 ? 0.0 : turned));
        Robot a("a", kOwn, 20.0), b("b", kOwn, -30.0);
        Air air(description);
        air.robots = {&a, &b};
        air.boot(100 * kMillisecond);
        begin_sessions(air);
        CAPTURE(place, distance, toward, turned);
        int heard = 0;
        for (int i = 0; i < 8; ++i) {
            const auto word = static_cast<std::uint8_t>(random.below(256));
            Robot& speaker = i % 2 == 0 ? a : b;
            Robot& listener = i % 2 == 0 ? b : a;
            speaker.send_word(air.now, word);
            listener.send_word(air.now, -1);
            air.run_for(kCycle);
            take_record(speaker);
            take_record(listener);
            speaker.send_word(air.now, -1);
            listener.send_word(air.now, -1);
            air.run_for(kCycle);
            CHECK(take_record(speaker).ircom_received == 0);
            const EpuckSensors sensors = take_record(listener);
            if (sensors.ircom_received != 1) continue;
            CHECK(int{sensors.ircom_data} == word);
            ++heard;
            if (place % 2 != 0) continue;
            CHECK((sensors.ircom_sensor == 0 || sensors.ircom_sensor == 7));
            CHECK(sensors.ircom_range == Approx(100 * distance).margin(0.8));
            const double off = std::remainder(double{sensors.ircom_bearing}, 2 * std::numbers::pi);
            CHECK(std::abs(off) == Approx(0.2967).margin(1e-4));
        }
        CHECK(heard == 8);
    }
}

TEST_CASE("proximity goes on between words, and no word is heard where none is sent") {
    auto description = world();
    add_robot(description, "a", 0, 0, 0);
    add_robot(description, "b", 0.1, 0, std::numbers::pi);  // its own proximity pulses are seen
    Robot a("a", kOwn), b("b", kOwn);
    Air air(description);
    air.robots = {&a, &b};
    air.boot(100 * kMillisecond);
    begin_sessions(air);
    a.inbox.push_back({air.now, pic::PicNode::kWorld, Signal{pic::kProximity + 7, 500.0}});
    int fresh = 0;
    for (int i = 0; i < 20; ++i) {
        a.send_word(air.now, -1);
        b.send_word(air.now, -1);
        air.run_for(kCycle);
        const EpuckSensors sensors = take_record(a);
        CHECK(sensors.ircom_received == 0);
        take_record(b);
        // Both began at the same time, so that b's pulses coincide with a's and add their light.
        fresh += sensors.proximity[7] > 470 && sensors.proximity[7] < 620 ? 1 : 0;
    }
    CHECK(fresh >= 19);
}

TEST_CASE("a robot with the own firmware and a booth with the own firmware talk") {
    if (kOwnTam.empty()) return;
    check_booth(kOwn, kOwnTam, 3, 42);
}

TEST_CASE("own and original firmwares understand each other in the booth", "[slow]") {
    const std::string tam = image_path("tam_firmware.elf");
    if (tam.empty()) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with tam_firmware.elf");
        return;
    }
    check_booth(kOwn, tam, 3, 43);
}
