// IRcom with the robots' and the booth's own images, unmodified: ARGoS' epuck_firmware.hex and the TAM's
// firmware. Words and places are drawn at random. Needs both in $PUCKLOOP_IMAGES.

#include "tests/ircom/air.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <numbers>

using namespace puckloop;
using namespace puckloop::ircom_test;
using protocols::EpuckSensors;

namespace {

const std::string kEpuckImage = image_path("epuck_firmware.hex");
const std::string kTamImage = image_path("tam_firmware.elf");

#define NEEDS_IMAGES()                                                                                       \
    if (kEpuckImage.empty() || kTamImage.empty()) {                                                          \
        WARN(                                                                                                \
            "skipped: PUCKLOOP_IMAGES does not name a folder with epuck_firmware.hex and tam_firmware.elf"); \
        return;                                                                                              \
    }

constexpr Time kBooted = 41 * kSecond;
constexpr Time kCycle = 125 * kMillisecond;  // an exchange does not fit 100 ms: docs/ircom.md

/// Sessions of all robots have begun.
void begin_sessions(Air& air) {
    for (Robot* robot : air.robots)
        robot->send(air.now, {1});
    air.run_for(200 * kMillisecond);
    for (Robot* robot : air.robots)
        robot->send(air.now, {0, 0, 0, 0});
    air.run_for(200 * kMillisecond);
    for (Robot* robot : air.robots) {
        REQUIRE(robot->received.size() == 72);
        robot->received.clear();
    }
}

/// The newest record.
EpuckSensors take_record(Robot& robot) {
    REQUIRE(robot.received.size() == 72);
    const auto sensors =
        protocols::decode_sensors(std::span<const std::uint8_t, 72>(robot.received.data(), 72));
    robot.received.clear();
    return sensors;
}

}  // namespace

TEST_CASE("words cross between the original firmwares of an e-puck and the booth that it is in", "[slow]") {
    NEEDS_IMAGES();
    RandomStream random(20, "booth");
    auto description = world();
    const double heading = 2 * std::numbers::pi * random.uniform();
    const double into = heading + std::numbers::pi + 0.2 * (random.uniform() - 0.5);
    add_robot(description, "robot0", 0.3 + 0.004 * (random.uniform() - 0.5), -0.2, into);
    add_booth(description, "tam0", 0.3, -0.2, heading);
    Robot robot("robot0", kEpuckImage, 15.0);
    tam::test::Booth booth(kTamImage);
    booth.rig.board.set_signal(tam::kBarrier + 1, 1.0);  // the back beam is interrupted
    Air air(description);
    air.robots = {&robot};
    air.booths = {&booth};
    air.booth_offset = kBooted - 4 * kSecond;
    air.boot(kBooted);
    begin_sessions(air);

    int heard_by_robot = 0, heard_by_booth = 0, tries = 0;
    for (int round = 0; round < 4; ++round) {
        const auto from_robot = static_cast<std::uint8_t>(1 + random.below(255));
        const auto from_booth = static_cast<std::uint8_t>(1 + random.below(255));
        booth.command({0x0C, from_booth});
        CAPTURE(round, int{from_robot}, int{from_booth});
        bool robot_heard = false, booth_heard = false;
        const std::size_t reports = booth.reports().size();
        for (int cycle = 0; cycle < 24 && !(robot_heard && booth_heard); ++cycle, ++tries) {
            robot.send_word(air.now, from_robot);
            air.run_for(kCycle + static_cast<Time>(random.below(20)) * kMillisecond);
            const EpuckSensors sensors = take_record(robot);
            if (sensors.ircom_received == 1 && sensors.ircom_data == from_booth) {
                robot_heard = true;
                // The booth's diode is on the robot's right, ahead: sensors 1 and 2.
                CHECK((sensors.ircom_sensor == 1 || sensors.ircom_sensor == 2));
            }
            const auto all = booth.reports();
            for (std::size_t i = reports; i < all.size(); ++i)
                booth_heard |= all[i].second.back() == from_robot;
        }
        heard_by_robot += robot_heard ? 1 : 0;
        heard_by_booth += booth_heard ? 1 : 0;
    }
    CHECK(heard_by_robot == 4);
    CHECK(heard_by_booth == 4);
    WARN("cycles of the robot for four words each way: " << tries);

    // The booth's half periods: timer 2's prescaler runs on, so they are whole ticks of 4 us but for the few
    // cycles by which the interrupt begins later or earlier; the first of a symbol is written later. The fact
    // sheet expects 264 and 524 us for a counter written 7.6 us after the overflow; this image takes some 180
    // cycles, 11 us, to the write (float to integer included), two ticks and not one.
    std::map<Time, int> gaps;
    Time before = 0;
    for (const auto& change : booth.rig.of(tam::kProximityEmit)) {
        const Time gap = change.at - before;
        before = change.at;
        if (gap > 100 * kMicrosecond && gap < 700 * kMicrosecond)
            ++gaps[(gap + kMicrosecond) / (2 * kMicrosecond) * 2];
    }
    int marks = 0, spaces = 0, all = 0;
    for (const auto& [microseconds, times] : gaps) {
        all += times;
        if (microseconds == 268) marks = times;
        if (microseconds == 528) spaces = times;
    }
    CHECK(all > 1000);
    CHECK(marks + spaces > 0.9 * all);
    CHECK(spaces > 100);
}

TEST_CASE("two robots with the original firmware hear each other, and how far away", "[slow]") {
    NEEDS_IMAGES();
    RandomStream random(21, "robots");
    for (int place = 0; place < 2; ++place) {
        const double distance = 0.085 + 0.09 * random.uniform();
        const double toward = 2 * std::numbers::pi * random.uniform();
        auto description = world();
        add_robot(description, "a", 0, 0, toward);
        add_robot(description, "b", distance * std::cos(toward), distance * std::sin(toward),
                  toward + std::numbers::pi);
        Robot a("a", kEpuckImage, 12.0, 1.0), b("b", kEpuckImage, -25.0, 1.0);
        Air air(description);
        air.robots = {&a, &b};
        air.boot(kBooted);
        begin_sessions(air);
        CAPTURE(distance, toward);
        int heard = 0, bad = 0;
        for (int cycle = 0; cycle < 6; ++cycle) {
            const auto word = static_cast<std::uint8_t>(random.below(256));
            // b listens while a sends: both are busy with a word of their own at the beginning of a cycle.
            b.send_word(air.now, 0x5A);
            air.run_for(45 * kMillisecond);
            a.send_word(air.now, word);
            air.run_for(kCycle);
            const EpuckSensors sensors = take_record(b);
            a.received.clear();
            if (sensors.ircom_received != 1) continue;
            if (sensors.ircom_data != word) {
                ++bad;
                continue;
            }
            ++heard;
            CHECK((sensors.ircom_sensor == 0 || sensors.ircom_sensor == 7));
            // Its table is in steps of half a centimetre, between which it interpolates the wrong way round.
            CHECK(sensors.ircom_range == Approx(100 * distance).margin(0.8));
        }
        CHECK(heard >= 4);
        CHECK(bad == 0);
    }
}

TEST_CASE("a robot understands neither of two beside it that talk at once", "[slow]") {
    NEEDS_IMAGES();
    RandomStream random(22, "collision");
    auto description = world();
    // Both in front of the same sensor: one on either side would be distinguished.
    const double aside = std::atan2(0.036, 0.15);
    add_robot(description, "a", -0.15, 0.036, -aside);
    add_robot(description, "b", 0, 0, std::numbers::pi / 2);
    add_robot(description, "c", -0.15, -0.036, aside);
    Robot a("a", kEpuckImage, 12.0, 1.0), b("b", kEpuckImage, -25.0, 1.0), c("c", kEpuckImage, 3.0, 1.0);
    Air air(description);
    air.robots = {&a, &b, &c};
    air.boot(kBooted);
    begin_sessions(air);
    int alone = 0, together = 0;
    for (int cycle = 0; cycle < 12; ++cycle) {
        const auto first = static_cast<std::uint8_t>(random.below(256));
        const auto second = static_cast<std::uint8_t>(random.below(256));
        const bool both = cycle % 2 == 0;
        b.send_word(air.now, 0x5A);
        air.run_for(45 * kMillisecond);
        a.send_word(air.now, first);
        air.run_for(4 * kMillisecond);
        if (both) c.send_word(air.now, second);
        air.run_for(kCycle);
        const EpuckSensors sensors = take_record(b);
        a.received.clear();
        c.received.clear();
        const bool understood = sensors.ircom_received == 1 &&
                                (sensors.ircom_data == first || (both && sensors.ircom_data == second));
        (both ? together : alone) += understood ? 1 : 0;
    }
    CHECK(alone >= 3);
    CHECK(together <= 1);
}
