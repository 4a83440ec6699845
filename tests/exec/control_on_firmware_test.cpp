// The control program's session against emulated boards: our firmware always, the original where the real
// image is at hand. Faults and restarts must end in step, with the wheels obeying.

#include "linuxboard/control/control_loop.h"
#include "tests/exec/bench_line.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using exec::BenchLine;
using exec::Rig;

namespace {

const std::string kOwn = std::string(PUCKLOOP_FIRMWARE) + "/epuck/epuck.hex";
constexpr double kOwnReady = 0.05;       // s after power-up
constexpr double kOwnBoot = 0.05;        // s after a reset
constexpr double kOriginalReady = 39.9;  // the program resets itself once
constexpr double kOriginalBoot = 20;

class Straight : public control::Behaviour {
    control::Actuators step(const control::Sensors&, double) override {
        return {.left_mm_s = 40, .right_mm_s = 40, .ring_leds = 0x01};
    }
};

struct Mission {
    Mission(const std::string& image, double ready) : rig("pic", image) { rig.run_to(ready); }
    /// One session from wake-up to end record; may be repeated.
    bool run(double duration) {
        settings.duration = duration;
        const double before = rig.get("wheel_left");
        control::Session session{line, [](const std::string&) {}, [] { return false; }};
        const bool reached = run_control_loop(
            session, line, behaviour, control::Surroundings{}, [] { return false; }, settings);
        line.sleep_until(line.now() + 0.25);
        counters = session.counters();
        steps = rig.get("wheel_left") - before;
        return reached;
    }
    void check_ended() {
        const double still = rig.get("wheel_left");
        rig.run_for(0.3);
        CHECK(rig.get("wheel_left") == still);
        CHECK(rig.get("led0") == 0);
    }

    Rig rig;
    BenchLine line{rig};
    Straight behaviour;
    control::LoopSettings settings;
    control::SessionCounters counters;
    double steps = 0;
};

void check_quiet(Mission& mission) {
    const unsigned long sent = mission.line.sent;
    REQUIRE(mission.run(5));
    const auto& c = mission.counters;
    CHECK(c.frames == 50);
    CHECK(c.records == 51);
    CHECK(c.resyncs == 0);
    CHECK(c.stray_bytes == 0);
    CHECK(mission.line.sent - sent == 5 + 51 * 12);
    CHECK(mission.steps == Approx(311 * 4.9).epsilon(0.02));
    mission.check_ended();
}

void check_faults(Mission& mission) {
    for (const unsigned copies : {0U, 2U}) {
        for (unsigned long offset = 0; offset < 12; offset += copies == 0 ? 1 : 3) {
            mission.line.copies[mission.line.sent + 5 + 12 * 5 + offset] = copies;
            INFO("offset " << offset << " copies " << copies);
            REQUIRE(mission.run(2));
            CHECK(mission.counters.longest_gap < 0.7);
            CHECK(mission.steps > 311 * 1.0);
            mission.check_ended();
        }
    }
}

void check_pic_restart(Mission& mission, double boot) {
    mission.line.restarts = {mission.line.now() + 1.037};
    REQUIRE(mission.run(boot + 6));
    CHECK(mission.counters.longest_gap < boot + 2);
    CHECK(mission.steps > 311 * 3);
    mission.check_ended();
}

void check_program_restart(Mission& mission) {
    // A program that died: it had sent a record and a half.
    mission.line.write(std::vector<std::uint8_t>(5 + 12 + 7, 0));
    mission.line.sleep_until(mission.line.now() + 0.5);
    REQUIRE(mission.run(2));
    CHECK(mission.steps > 311 * 1.0);
    mission.check_ended();
}

}  // namespace

TEST_CASE("control program on our firmware: quiet, bytes lost and doubled, either side restarted") {
    Mission mission(kOwn, kOwnReady);
    check_quiet(mission);
    check_faults(mission);
    check_program_restart(mission);
    check_pic_restart(mission, kOwnBoot);
}

TEST_CASE("control program on the original firmware: quiet, bytes lost and doubled, either side restarted",
          "[real]") {
    const auto image = exec::real_image("epuck_firmware.hex");
    if (!image) return;
    Mission mission(*image, kOriginalReady);
    check_quiet(mission);
    check_faults(mission);
    check_program_restart(mission);
    check_pic_restart(mission, kOriginalBoot);
}
