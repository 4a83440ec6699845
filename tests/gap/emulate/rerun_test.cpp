// A robot that is not as the simulator believes is recorded; the overlay of the cause makes the emulator do
// what was measured, from the TOML file on to the readings.

#include "gap/overlay/overlay.h"
#include "gap/reading/read_experiment.h"
#include "scenarios/reader/read_scenario.h"
#include "selftest/emulate/reacts.h"
#include "selftest/emulate/record.h"
#include "selftest/emulate/rerun.h"
#include "selftest/emulate/surroundings.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// What the analysis would say: the test is of what follows from it.
Verdict named(const std::string& cause, const std::string& parameter, double value, double neutral) {
    Verdict verdict;
    verdict.decision = Decision::Named;
    verdict.causes.emplace_back();
    verdict.causes.back().name = cause;
    verdict.causes.back().parameters.push_back({parameter, "", value, value, value, neutral, true});
    return verdict;
}

Rerun again(const std::string& kind, const std::vector<std::string>& changes, const Verdict& verdict,
            bool floor = false) {
    const auto scratch = puckloop::tests::scratch_path("gap_rerun_" + kind);
    emulate::RecordOptions options;
    options.tools = {PUCKLOOP_RECORD, PUCKLOOP_FIRMWARE, PUCKLOOP_RAB_FIRMWARE};
    options.brief = true;
    options.scratch = scratch / "emulated";
    for (const std::string& change : changes)
        emulate::set_parameter(options.robot, change);
    write_folder(emulate::record(kind, options), scratch / "experiment");
    Experiment experiment = read_experiment(scratch / "experiment");
    if (kind == "motion") experiment.runs.resize(1);  // one drive tells
    std::ofstream(scratch / "overlay.toml") << overlay_toml(experiment, verdict);
    emulate::RerunOptions how;
    how.tools = options.tools;
    how.overlay = scratch / "overlay.toml";
    if (floor) how.truth = options.robot;
    how.scratch = scratch / "again";
    if (kind == "rab") how.longest = 1;  // few pairs of boards
    const Rerun result = emulate::rerun(experiment, verdict, how);
    std::filesystem::remove_all(scratch);
    INFO(result.not_done);
    REQUIRE(result.not_done.empty());
    return result;
}

}  // namespace

TEST_CASE("a wheel's size from an overlay drives the emulated robot as far as the measured one") {
    const Rerun result =
        again("motion", {"robot.wheel_radius_left=0.02112", "robot.wheel_radius_right=0.02112"},
              named("wheel_scale", "wheel_scale", 0.0302, 0.0), true);
    REQUIRE(result.observables.size() == 4);
    // The robot that was recorded is off by its tracker's noise, and no less than with the overlay.
    for (const RerunObservable& observable : result.observables) {
        INFO(observable.name);
        CHECK(observable.floor > 0);
        CHECK(observable.after < 1.25 * observable.floor);
        CHECK(observable.floor < 1.25 * observable.after);
    }
    CHECK(result.observables[0].before > 0.003);  // 3 % of up to half a metre
    CHECK(result.observables[0].after < 0.0012);  // the tracker's 0.5 mm in x and y
    CHECK(result.observables[1].after < 0.005);   // its 0.2 degrees
}

TEST_CASE("a late command from an overlay is late on the emulated line") {
    const Rerun result =
        again("motion", {"uart.delay=0.04"}, named("command_latency", "command.latency", 0.0433, 0.0033));
    CAPTURE(result.runs, result.observables[0].before, result.observables[1].before,
            result.observables[1].after);
    CHECK(result.observables[0].before > 0.0013);  // 1.5 mm for most of the drive, 40 ms at 39 mm/s
    CHECK(result.observables[0].after < 0.0009);   // the tracker's 0.5 mm in x and y
    CHECK(result.left_out.empty());
}

TEST_CASE("a sensor's gain from an overlay is the emulated sensor's") {
    const Rerun ground =
        again("ground", {"ground.gain1=0.9"}, named("ground_gain", "ground.gain1", 0.9, 1.0));
    CHECK(ground.observables[0].before > 15);
    CHECK(ground.observables[0].after < 3);  // noise of 1.5 counts
    const Rerun proximity =
        again("proximity", {"proximity.gain0=1.3"}, named("sensor_gain", "proximity.gain0", 1.3, 1.0));
    CHECK(proximity.observables[0].before > 20);
    CHECK(proximity.observables[0].after < 5);  // two conversions of 2 counts each
}

TEST_CASE("what warms up is looked at again as late as it was measured") {
    Verdict verdict = named("warm_up", "ground.warmup_gain", -0.2, 0.0);
    verdict.causes[0].parameters.push_back({"ground.warmup_time", "", 3, 3, 3, 300, true});
    const Rerun ground = again("ground", {"ground.warmup_gain=-0.2", "ground.warmup_time=3"}, verdict);
    CHECK(ground.observables[0].before > 50);  // 7 to 17 % of 330 to 950 counts
    CHECK(ground.observables[0].after < 4);    // a second's mean of what still drifts
}

TEST_CASE("a microphone's gain and an accelerometer's zero from an overlay are the emulated robot's") {
    const Rerun sound =
        again("microphone", {"microphone.gain1=1.6"}, named("microphone_gain", "microphone.gain1", 1.6, 1.0));
    CAPTURE(sound.observables[0].before, sound.observables[0].after);
    // A third of the rows are 60 % off; one window's level scatters by 12 %.
    CHECK(sound.observables[0].before > 2 * sound.observables[0].after);
    const Rerun tilt = again("accelerometer", {"accelerometer.bias0=40"},
                             named("accelerometer_bias", "accelerometer.bias0", 40, 0.0));
    REQUIRE(tilt.observables.size() == 6);
    CHECK(tilt.observables[0].before == Approx(40).margin(2));
    for (const auto& axis : tilt.observables)
        CHECK(axis.after < 3.5);                                // the converter's noise
    CHECK(tilt.observables[3].before == Approx(40).margin(2));  // a distribution moves as its mean does
}

TEST_CASE("a longer period is that of sleeps which end late") {
    const Rerun result =
        again("timing", {"host.period=0.104"}, named("long_period", "timing.extra_period", 0.004, 0.0));
    CHECK(result.observables[0].before > 0.01);
    CHECK(result.observables[0].after < 0.0004);  // the host's time stamps, 0.2 ms
}

TEST_CASE("a shorter period is that of sleeps which end early") {
    const Rerun result =
        again("timing", {"host.period=0.0963"}, named("long_period", "timing.extra_period", -0.0037, 0.0));
    CHECK(result.left_out.empty());
    CHECK(result.observables[0].before > 0.01);
    CHECK(result.observables[0].after < 0.0004);                         // the host's time stamps, 0.2 ms
    CHECK(result.observables[1].before == Approx(0.0037).margin(2e-4));  // of each interval
    CHECK(result.observables[1].after < 0.0004);
}

TEST_CASE("bytes on the line come as fast as the overlay's crystal") {
    const Rerun result = again("serial", {"board.crystal_ppm=-160"},
                               named("clock_drift", "timing.clock_drift", 0.00016, 0.0), true);
    REQUIRE(result.observables.size() == 1);
    // 160 ppm of 83 bytes are 1.15 us from end to end; the analyser's noise is 0.1 us.
    CHECK(result.observables[0].before > 2.5e-7);
    CHECK(result.observables[0].after < 1.25 * result.observables[0].floor);
    CHECK(result.observables[0].floor == Approx(1e-7).epsilon(0.1));
}

TEST_CASE("frames that chance breaks are compared by their share") {
    const Rerun result =
        again("timing", {"uart.cut=0.2"}, named("truncation", "timing.truncation", 0.2, 0.0), true);
    REQUIRE(result.observables.size() == 3);
    const RerunObservable& share = result.observables[2];
    CAPTURE(share.before, share.after, share.floor, share.floor_limit);
    CHECK(share.before > 0.1);
    CHECK(share.after < share.before / 2);
    CHECK(share.floor > 0);  // chance differs from one performance to the next
    CHECK(share.floor_limit > share.floor);
}

TEST_CASE("a host that polls seldom is performed again with the time between its polls") {
    const Rerun result =
        again("rab", {"host.rab_poll=0.08"}, named("poll_loss", "rab.fetch_time", 0.08, 0.0));
    const RerunObservable& received = result.observables.back();
    REQUIRE(received.name == "received");
    CHECK(received.before > 0.1);
    CHECK(received.after < received.before / 5);
    CHECK(result.left_out.empty());
}

TEST_CASE("a receiver's gain and reflections from an overlay are those of the emulated boards") {
    const Rerun gain = again("rab", {"ir.receiver_gain3=1.8"},
                             named("strength_spread_parts", "rab.receiver_gain4", 1.8, 1.0));
    REQUIRE(gain.observables.size() == 5);
    CHECK(gain.observables[0].before > 1.1 * gain.observables[0].after);  // one receiver of twelve
    Verdict stray = named("multipath", "rab.multipath", 0.3, 0.0);
    stray.causes[0].parameters.push_back({"rab.multipath_loss", "", 1.0, 1.0, 1.0, 0.7, true});
    const Rerun bent = again("rab", {"ir.stray=0.3", "ir.stray_loss=1"}, stray);
    CHECK(bent.observables[1].before > 0.25);  // scatter of a strength: 0.3 of 0.7 at a loss of 1
    CHECK(bent.observables[1].after < bent.observables[1].before / 2);
    CHECK(bent.observables[3].after < bent.observables[3].before / 2);  // of a bearing
}

TEST_CASE("what cannot be performed again is said, and leaves nothing behind") {
    const auto scratch = puckloop::tests::scratch_path("gap_rerun_impossible");
    emulate::RecordOptions options;
    options.tools = {PUCKLOOP_RECORD, PUCKLOOP_FIRMWARE, PUCKLOOP_RAB_FIRMWARE};
    options.brief = true;
    options.scratch = scratch / "emulated";
    write_folder(emulate::record("timing", options), scratch / "experiment");
    const Experiment experiment = read_experiment(scratch / "experiment");
    const Verdict verdict = named("truncation", "timing.truncation", 1.0, 0.0);
    std::ofstream(scratch / "overlay.toml") << overlay_toml(experiment, verdict);
    emulate::RerunOptions how;
    how.tools = options.tools;
    how.overlay = scratch / "overlay.toml";
    how.scratch = scratch / "again";
    SECTION("the overlay stops the robot's line") {
        CHECK_THAT(emulate::rerun(experiment, verdict, how).not_done, Catch::Contains("does not answer"));
    }
    SECTION("the recorder is missing") {
        how.tools.record = scratch / "nothing";
        CHECK_THAT(emulate::rerun(experiment, verdict, how).not_done, Catch::Contains("nothing"));
    }
    SECTION("the overlay is no overlay") {
        std::ofstream(how.overlay) << "[parameters]\n\"push.rate\" = 7\n";
        CHECK_THAT(emulate::rerun(experiment, verdict, how).not_done, Catch::Contains("push.rate"));
    }
    CHECK(!std::filesystem::exists(how.scratch));
    std::filesystem::remove_all(scratch);
}

TEST_CASE("an overlay's links and clocks reach every robot of a scenario") {
    const auto scratch = puckloop::tests::scratch_path("gap_overlay_links");
    std::filesystem::create_directories(scratch);
    std::ofstream(scratch / "overlay.toml") << "[uart]\ncommand_delay = \"30 ms\"\nanswer_loss = 0.001\n"
                                               "[clock]\npic_error = \"250 ppm\"\n";
    auto scenario = scenarios::read_scenario(PUCKLOOP_SCENARIO);
    const auto faults = scenario.faults.size();
    const double before = scenario.robots[0].pic.crystal_ppm;
    scenarios::apply_overlay(scenario, scratch / "overlay.toml");
    REQUIRE(scenario.faults.size() == faults + 2 * scenario.robots.size());
    CHECK(scenario.faults[faults].kind == "delay");
    CHECK(scenario.faults[faults].parameters.number("delay") == Approx(0.03));
    CHECK(scenario.faults[faults].from == scenario.robots[0].name + ".linux");
    CHECK(scenario.faults[faults + 1].kind == "drop");
    CHECK(scenario.faults[faults + 1].probability == Approx(0.001));
    CHECK(scenario.robots[0].pic.crystal_ppm == Approx(before + 250));
    // A drift at the end of its range is a crystal beyond what a run takes.
    std::ofstream(scratch / "overlay.toml")
        << overlay_toml({}, named("clock_drift", "timing.clock_drift", -0.2, 0.0));
    scenarios::apply_overlay(scenario, scratch / "overlay.toml");
    CHECK(scenario.robots[0].pic.crystal_ppm == Approx(before + 250 + 2e5));
    std::filesystem::remove_all(scratch);
}

TEST_CASE("load and tilt of the table are noted beside a run, and set up again from there") {
    emulate::Act act;
    act.load = 0.2;
    act.slope_x = 0.08;
    act.slope_y = -0.03;
    const bool turns = GENERATE(true, false);
    WrittenRun noted;
    std::vector<emulate::Row> rows(40);
    Run run;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].theta = 0.5 + (turns ? 0.1 * static_cast<double>(i) : 0.0);
        run.columns["theta_rad"].push_back(rows[i].theta);
    }
    emulate::note_surroundings(act, rows, noted);
    run.rows = rows.size();
    for (const char* name : {"load_kg", "incline_rad"})
        run.columns[name] = noted.column(name).values;
    const auto rise = [](const emulate::Act& a, double theta) {
        return std::sin(a.slope_x) * std::cos(theta) + std::sin(a.slope_y) * std::sin(theta);
    };
    CHECK(run.columns["incline_rad"].back() == Approx(std::asin(rise(act, rows.back().theta))).margin(1e-4));
    emulate::Act again;
    emulate::restore_surroundings(run, again);
    CHECK(again.load == 0.2);
    // A line tells the tilt along itself only.
    for (const emulate::Row& row : rows)
        CHECK(rise(again, row.theta) == Approx(rise(act, row.theta)).margin(1e-4));
    CHECK(again.slope_x == Approx(turns ? 0.08 : rise(act, 0.5) * std::cos(0.5)).margin(2e-4));
    CHECK(again.slope_y == Approx(turns ? -0.03 : rise(act, 0.5) * std::sin(0.5)).margin(2e-4));
    emulate::Act flat;
    emulate::restore_surroundings(Run{}, flat);
    CHECK((flat.load == 0.0 && flat.slope_x == 0.0 && flat.slope_y == 0.0));
}

TEST_CASE("what cannot be performed again is said, not guessed") {
    Experiment experiment;
    experiment.kind = Kind::Rab;
    emulate::RerunOptions how;
    CHECK(emulate::rerun(experiment, {}, how).not_done.find("nothing was named") != std::string::npos);
    const Verdict verdict = named("microphone_gain", "microphone.gain0", 1.2, 1.0);
    CHECK(emulate::rerun(experiment, verdict, how).not_done.find("distance") != std::string::npos);
    experiment.kind = Kind::Motion;  // no word of its firmware
    CHECK(emulate::rerun(experiment, verdict, how).not_done.find("firmware") != std::string::npos);
}

TEST_CASE("where time matters a standing robot is looked at when its row was measured") {
    Experiment experiment;
    experiment.kind = Kind::Microphone;
    Run run;
    run.rows = 2;
    run.columns = {{"t_s", {1.0, 12.0}},       {"mic", {0, 0}},       {"distance_m", {0.2, 0.2}},
                   {"angle_rad", {0.0, 0.0}},  {"level", {5.0, 9.0}}, {"amplitude", {600, 600}},
                   {"motor_speed", {0.0, 0.0}}};
    experiment.runs.push_back(run);
    emulate::Performed performed;
    for (int k = 0; k < 200; ++k) {
        emulate::Row row{};
        row.t = row.powered = 0.1 * k;
        row.ok = true;
        row.mic[0] = row.t < 6 ? 5.0 : 9.0;
        performed.rows.push_back(row);
    }
    for (const double longest : {0.0, 20.0}) {
        std::string why;
        const auto reacts = emulate::reacts_of(experiment, longest, why);
        REQUIRE(reacts.size() == 1);
        std::vector<emulate::Comparison> comparisons(2);
        emulate::compare(experiment, reacts.front(), performed, performed, comparisons);
        const double error = comparisons.front().off_by().value_or(NAN);
        if (longest > 0) {
            CHECK(reacts.front().act.commands.back().seconds >= 12.0);
            CHECK(error == 0.0);
        } else {
            CHECK(reacts.front().act.commands.back().seconds < 5.0);
            CHECK(error > 1.0);
        }
    }
}
