// Experiments recorded on the emulator: what a laboratory would have, and what the robot really did.

#include "base/error.h"
#include "gap/data/experiment.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "physics/sensors/ground.h"
#include "selftest/emulate/record.h"
#include "selftest/emulate/secrets.h"
#include "selftest/emulate/wave_floor.h"
#include "tests/gap/simulated.h"
#include "tests/kit/scratch.h"
#include "tests/kit/shell.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <regex>
#include <set>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

emulate::RecordOptions options_in(const std::filesystem::path& scratch) {
    emulate::RecordOptions options;
    options.tools = {PUCKLOOP_RECORD, PUCKLOOP_FIRMWARE, PUCKLOOP_RAB_FIRMWARE};
    options.brief = true;
    options.scratch = scratch;
    return options;
}

Experiment recorded(const std::string& kind, emulate::RecordOptions& options) {
    const auto folder = options.scratch / "experiment";
    write_folder(emulate::record(kind, options), folder);
    Experiment experiment = read_experiment(folder);
    std::filesystem::remove_all(options.scratch);
    return experiment;
}

}  // namespace

TEST_CASE("a recorded line is as long as the firmware's timers make it") {
    auto options = options_in(tests::scratch_path("gap_line"));
    const Experiment experiment = recorded("motion", options);
    REQUIRE(experiment.runs.size() >= 3);
    const Run& run = experiment.runs.front();
    const double command = 300, seconds = 5;
    // Timer counts of a step are whole at 230.4 kHz; 41 mm wheels, 1000 steps a turn.
    const double speed = 230400 / std::round(230400 / command);
    const double expected = speed * seconds * std::numbers::pi * 0.041 / 1000;
    const double way = std::hypot(run.column("x_m").back() - run.column("x_m").front(),
                                  run.column("y_m").back() - run.column("y_m").front());
    CHECK(way == Approx(expected).margin(0.003));  // tracker 0.5 mm, and less than a row of commands
}

TEST_CASE("a changed gain shows in one sensor, and the folder does not tell of it") {
    auto options = options_in(tests::scratch_path("gap_gain"));
    const Experiment plain = recorded("proximity", options);
    CHECK(plain.rows() > 50);
    emulate::set_parameter(options.robot, "proximity.gain0=1.3");
    const Experiment changed = recorded("proximity", options);
    REQUIRE(changed.rows() == plain.rows());
    double most = 0.0;
    for (std::size_t r = 0; r < plain.runs.size(); ++r)
        for (std::size_t k = 0; k < plain.runs[r].rows; ++k) {
            const double difference =
                changed.runs[r].column("reading")[k] - plain.runs[r].column("reading")[k];
            if (plain.runs[r].column("sensor")[k] == 0.0)
                most = std::max(most, difference);
            else
                CHECK(std::abs(difference) < 12);  // converter noise of two conversions, twice
        }
    CHECK(most > 100);
    CHECK(changed.nominal == plain.nominal);
}

TEST_CASE("ground and timing can be recorded") {
    auto options = options_in(tests::scratch_path("gap_ground"));
    const Experiment ground = recorded("ground", options);
    CHECK(ground.rows() > 100);
    const Experiment timing = recorded("timing", options);
    const auto& host = timing.runs.front().column("t_host_s");
    CHECK((host.back() - host.front()) / static_cast<double>(host.size() - 1) == Approx(0.1).margin(2e-4));
}

TEST_CASE("the wave floor's grey is what the simulator's ground row sees of it") {
    // Read back from the text: each stripe's middle and grey.
    const std::string floor = emulate::wave_floor();
    std::vector<physics::Patch> patches;
    const std::regex stripe(
        R"(centre = \["([-0-9.e]+) m".*\nsize = \["([-0-9.e]+) m".*\ngrey = ([-0-9.e]+))");
    for (std::sregex_iterator at(floor.begin(), floor.end(), stripe), end; at != end; ++at) {
        physics::Patch patch;
        patch.x = std::stod((*at)[1]);
        patch.length = std::stod((*at)[2]);
        patch.width = 1.8;
        patch.grey = std::stod((*at)[3]);
        patches.push_back(patch);
    }
    REQUIRE(patches.size() > 1000);
    const physics::Parameters parameters;
    const physics::GroundRow row(parameters.ground, 1.0, patches);
    for (const double x : {-0.1411, -0.0502, 0.0001, 0.0333, 0.1207}) {
        const double seen = row.greys({.x = x - parameters.ground.x})[1];
        CHECK(emulate::wave_grey(x) == Approx(seen).margin(1e-9));
        CHECK((emulate::wave_grey(x + 0.01) - emulate::wave_grey(x - 0.01)) / 0.02 ==
              Approx(emulate::wave_slope(x)).margin(0.3));
    }
}

TEST_CASE("the serial line tells the main board's crystal") {
    auto options = options_in(tests::scratch_path("gap_serial"));
    emulate::set_parameter(options.robot, "board.crystal_ppm=-300");
    const Experiment serial = recorded("serial", options);
    REQUIRE(serial.kind == Kind::Timing);
    REQUIRE(serial.runs.size() == 8);
    const auto &host = serial.runs[3].column("t_host_s"), &robot = serial.runs[3].column("t_robot_s");
    REQUIRE(host.size() == 72);
    // 6 ms, timed to 0.1 us at both ends.
    CHECK((host.back() - host.front()) / (robot.back() - robot.front()) == Approx(1.0003).margin(6e-5));
}

TEST_CASE(
    "range and bearing is recorded through the boards' firmware, and is what the model with the ring says") {
    auto options = options_in(tests::scratch_path("gap_rab"));
    for (const char* part : {"ir.emitter_spread", "ir.receiver_spread", "ir.demodulator_spread"})
        emulate::set_parameter(options.robot, std::string(part) + "=0");
    const Experiment plain = recorded("rab", options);
    REQUIRE(plain.kind == Kind::Rab);
    REQUIRE(plain.runs.size() == 4);
    for (const Series& series : test::simulated(plain)) {
        if (series.observable == "received") continue;
        double mean = 0.0;
        for (std::size_t i = 0; i < series.measured.size(); ++i)
            mean += (series.measured[i] - series.before[i]) / static_cast<double>(series.measured.size());
        INFO(series.observable << " " << mean);
        REQUIRE(series.measured.size() > 100);
        CHECK(std::abs(mean) < 0.03);  // chance of 0.1 to 0.35 a message; of a bearing 0.05 rad
    }
    emulate::set_parameter(options.robot, "ir.receiver_gain=0.5");
    const Experiment weak = recorded("rab", options);
    double sum = 0.0, count = 0.0;
    for (std::size_t r = 0; r < plain.runs.size(); ++r)
        for (std::size_t k = 0; k < plain.runs[r].rows; ++k) {
            const double ratio = weak.runs[r].column("strength")[k] / plain.runs[r].column("strength")[k];
            if (std::isnan(ratio)) continue;
            sum += ratio;
            ++count;
        }
    CHECK(count > 100);
    CHECK(sum / count == Approx(0.5).margin(0.02));
}

TEST_CASE("a host that polls too slowly gets a message a poll once the board's queue is full") {
    auto options = options_in(tests::scratch_path("gap_rab_poll"));
    emulate::set_parameter(options.robot, "host.rab_poll=0.06");
    const Experiment slow = recorded("rab", options);
    double read = 0.0, sent = 0.0;
    for (const Run& run : slow.runs)
        for (std::size_t k = 0; k < run.rows; ++k) {
            if (run.column("arrival_rate")[k] == 0.0) {
                CHECK(run.column("received")[k] == 1.0);
                continue;
            }
            read += run.column("received")[k];
            ++sent;
        }
    REQUIRE(sent == 16);
    CHECK(read / sent == Approx(24.0 / 60).margin(0.1));
}

TEST_CASE("a line so late that no exchange is answered is told, not recorded") {
    auto options = options_in(tests::scratch_path("gap_unanswered"));
    emulate::set_parameter(options.robot, "uart.delay=0.06");  // the session gives up after 64 ms
    CHECK_THROWS_AS(emulate::record("timing", options), RunError);
    std::filesystem::remove_all(options.scratch);
}

TEST_CASE("what cannot be recorded or changed is refused in one line") {
    auto options = options_in(tests::scratch_path("gap_refused"));
    CHECK_THROWS_AS(emulate::record("camera", options), InputError);
    CHECK_THROWS_AS(emulate::set_parameter(options.robot, "robot.axle_lenght=0.05"), InputError);
    CHECK_THROWS_AS(emulate::set_parameter(options.robot, "robot.axle_length"), InputError);
}

TEST_CASE("the recording program refuses a period that is none, in one line") {
    const std::string period = GENERATE("0", "-1", "nan", "0.1s", "soon");
    const tests::Ran ran =
        tests::run_in_shell(std::string(PUCKLOOP_RECORD) + " --script none --log none --period " + period);
    CHECK(ran.status == 2);
    CHECK(ran.output == "puckloop-record: --period " + period + ": expected at least 0.01 seconds\n");
}

TEST_CASE("every secret can be set, and at least twelve hide something") {
    std::size_t changes = 0, unknown = 0;
    for (std::size_t k = 0; k < emulate::secrets().size(); ++k) {
        const auto& secret = emulate::secrets()[k];
        INFO(secret.kind << ": " << secret.what);
        std::set<std::string> drawn;
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            emulate::Robot robot;
            for (const auto& assignment : emulate::drawn_assignments(secret, k, seed)) {
                emulate::set_parameter(robot, assignment);
                drawn.insert(assignment);
            }
        }
        emulate::Robot robot;
        for (const auto& assignment : emulate::closed_assignments(secret))
            emulate::set_parameter(robot, assignment);
        CHECK(emulate::drawn_assignments(secret, k, 3) == emulate::drawn_assignments(secret, k, 3));
        CHECK(secret.settings.empty() == secret.names.empty());
        CHECK(drawn.size() >= 18 * secret.settings.size());
        for (const auto& draw : secret.draws) {
            CHECK(draw.low < draw.high);
            CHECK(*draw.source != '\0');
        }
        changes += secret.names.empty() ? 0 : 1;
        unknown += secret.unknown ? 1 : 0;
    }
    CHECK(emulate::secrets().size() >= 60);
    CHECK(changes >= 40);
    CHECK(4 * unknown >= emulate::secrets().size());
}

TEST_CASE("what a change shows in is known from the catalogue and the sensors") {
    using Kinds = std::vector<std::string>;
    CHECK(emulate::kinds_showing("robot.axle_length") == Kinds{"motion"});
    CHECK(emulate::kinds_showing("robot.wheel_radius_right") == Kinds{"motion"});
    CHECK(emulate::kinds_showing("contact.mu") == Kinds{"motion"});
    CHECK(emulate::kinds_showing("proximity.gain3") == Kinds{"proximity"});
    CHECK(emulate::kinds_showing("proximity.amplitude") == Kinds{"proximity"});
    CHECK(emulate::kinds_showing("accelerometer.motor_sag") == Kinds{"accelerometer"});
    CHECK(emulate::kinds_showing("ir.stray") == Kinds{"rab"});
    CHECK(emulate::kinds_showing("uart.cut") == Kinds{"timing"});
    CHECK(emulate::kinds_showing("world.slope_x").empty());
    // Whatever a secret robot was changed in shows in the kind that it is recorded by.
    for (const emulate::Secret& secret : emulate::secrets())
        for (const emulate::Setting& setting : secret.settings) {
            std::string name = setting.parameter;
            if (name.ends_with('*')) name.back() = '0';
            INFO(name << " in " << secret.kind);
            const Kinds kinds = emulate::kinds_showing(name);
            CHECK((kinds.empty() || std::count(kinds.begin(), kinds.end(), secret.kind) == 1));
        }
}
