// What is wrong inside the columns: units, exchanged columns, clocks, constants, missing and impossible
// values.

#include "gap/models/model.h"
#include "gap/reading/read_experiment.h"
#include "gap/validate/checks.h"
#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

#include <functional>
#include <numbers>

using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

std::string degrees(std::size_t, double value) {
    return fmt::format("{:.6g}", value * 57.29578);
}

}  // namespace

TEST_CASE("clean experiments of every kind are read without a word about their columns") {
    for (const char* kind :
         {"proximity", "motion", "rab", "microphone", "ground", "accelerometer", "timing"}) {
        INFO(kind);
        const std::string cautions = cautions_of(clean(kind));
        for (const char* word : {"swapped", "unit", "impossible", "missing", "clock", "hang"})
            CHECK_THAT(cautions, !Contains(word));
    }
}

TEST_CASE("wrong units are refused") {
    CHECK_THAT(refusal(scaled(clean("proximity"), "distance_m", 100)), Contains("unit"));
    CHECK_THAT(refusal(scaled(clean("proximity"), "distance_m", 1000)), Contains("unit"));
    CHECK_THAT(refusal(changed(clean("proximity"), "angle_rad", degrees)), Contains("unit"));
    CHECK_THAT(refusal(scaled(scaled(clean("motion"), "x_m", 1000), "y_m", 1000)), Contains("unit"));
    CHECK_THAT(refusal(scaled(scaled(clean("motion"), "x_m", 100), "y_m", 100)), Contains("unit"));
    CHECK_THAT(refusal(changed(clean("motion"), "theta_rad", degrees)), Contains("degrees"));
    for (const double factor : {0.01, 1 / 6.2832})
        CHECK_THAT(refusal(scaled(clean("motion"), "theta_rad", factor)), Contains("unit"));
    CHECK_THAT(refusal(scaled(clean("motion"), "t_s", 1000)), Contains("unit of t_s"));
    CHECK_THAT(refusal(scaled(clean("timing"), "t_host_s", 1000)), Contains("unit"));
    CHECK_THAT(refusal(scaled(scaled(clean("timing"), "t_host_s", 1000), "t_robot_s", 1000)),
               Contains("nominal_period"));
    CHECK_THAT(refusal(scaled(clean("ground"), "grey", 255)), Contains("unit"));
    CHECK_THAT(refusal(scaled(clean("rab"), "distance_m", 100)), Contains("unit"));
    CHECK_THAT(refusal(changed(clean("rab"), "bearing_rad", degrees)), Contains("unit"));
    CHECK_THAT(refusal(scaled(clean("microphone"), "distance_m", 100)), Contains("unit"));
}

TEST_CASE("one damaged frame number is missing, a counter that wraps goes on") {
    const auto numbers = [](const std::function<double(std::size_t)>& number) {
        return changed(clean("timing"), "seq",
                       [&](std::size_t i, double) { return fmt::format("{:.0f}", number(i)); });
    };
    for (const double damaged : {5e9, 0.0})
        CHECK_THAT(cautions_of(numbers(
                       [&](std::size_t i) { return i == 20 ? damaged : 100.0 + static_cast<double>(i); })),
                   Contains("in row 21 lies beyond both its neighbours"));
    CHECK_THAT(cautions_of(numbers([](std::size_t i) { return static_cast<double>(i < 20 ? i : i + 50); })),
               !Contains("neighbours"));  // frames that are missing
    CHECK_THAT(cautions_of(numbers([](std::size_t i) { return static_cast<double>((i + 240) % 256); })),
               Contains("wraps at 256"));
}

TEST_CASE("a drive without counters: seconds, radians and holes of the record") {
    Made driven = clean("motion");
    for (const char* counter : {"steps_left", "steps_right"}) {
        const auto at = static_cast<std::ptrdiff_t>(place_of(driven, counter));
        driven.names.erase(driven.names.begin() + at);
        for (auto& row : driven.rows)
            row.erase(row.begin() + at);
    }
    CHECK_THAT(cautions_of(driven), !Contains("no rows for"));
    CHECK_THAT(refusal(scaled(driven, "t_s", 1000)), Contains("unit of t_s"));
    CHECK_THAT(refusal(changed(driven, "theta_rad", degrees)), Contains("degrees?"));
    driven.rows.erase(driven.rows.begin() + 20, driven.rows.begin() + 45);
    CHECK_THAT(cautions_of(driven), Contains("no rows for 2.6 s before row 21"));
}

TEST_CASE("a host that hands frames over in batches is no robot's clock") {
    constexpr double kBatch = 0.0125;  // s: an eighth of the period, so that most intervals are alike
    Made made = clean("timing");
    puckloop::RandomStream random(3, "batches");
    double robot = 0.0;
    for (auto& row : made.rows) {
        robot += 0.1 + 3e-4 * random.normal();
        row[place_of(made, "t_robot_s")] = fmt::format("{:.7f}", robot);
        row[place_of(made, "t_host_s")] = fmt::format("{:.7f}", kBatch * std::ceil(robot / kBatch));
    }
    CHECK(refusal(made) == "");
    CHECK_THAT(refusal(swapped(made, "t_robot_s", "t_host_s")), Contains("swapped"));
}

TEST_CASE("swapped columns are refused, or said where both are plausible") {
    const auto said = [](const char* kind, const char* a, const char* b) {
        return refusal(swapped(clean(kind), a, b));
    };
    CHECK_THAT(said("proximity", "distance_m", "reading"), Contains("swapped"));
    CHECK_THAT(said("motion", "steps_left", "steps_right"), Contains("swapped"));
    CHECK_THAT(said("motion", "cmd_left", "cmd_right"), Contains("swapped"));
    CHECK_THAT(said("motion", "x_m", "y_m"), Contains("swapped"));
    CHECK_THAT(refusal(scaled(clean("motion"), "cmd_left", -1)),
               Contains("steps_left runs against cmd_left"));
    CHECK(said("motion", "y_m", "theta_rad") != "");
    CHECK_THAT(said("ground", "grey", "reading"), Contains("swapped"));
    CHECK_THAT(said("accelerometer", "ax", "az"), Contains("swapped"));
    CHECK_THAT(said("accelerometer", "ax", "ay"), Contains("swapped"));
    CHECK_THAT(said("timing", "t_robot_s", "t_host_s"), Contains("swapped"));
    CHECK_THAT(said("rab", "distance_m", "strength"), Contains("swapped"));
    CHECK_THAT(said("microphone", "distance_m", "level"), Contains("swapped"));
    // Distances and angles of the same size: only what they do to the reading tells.
    Made made = clean("proximity");
    for (auto& row : made.rows)
        row[3] = fmt::format("{}", 0.01 * (std::stod(row[0]) * 10 - 10 * std::floor(std::stod(row[0]))));
    CHECK_THAT(cautions_of(swapped(made, "distance_m", "angle_rad")), Contains("swapped"));
}

TEST_CASE("an experiment in which no message arrives is refused") {
    const auto received = [](const char* even) {
        return refusal(changed(clean("rab"), "received",
                               [=](std::size_t i, double) { return std::string(i % 2 == 0 ? even : "0"); }));
    };
    CHECK_THAT(received("0"), Contains("received is 0 in every row"));
    CHECK(received("1").empty());
}

TEST_CASE("bearings told the other way round are refused, offsets are not") {
    Made made = clean("rab");
    made = changed(made, "true_bearing_rad", [](std::size_t i, double) {
        return fmt::format("{}", -3 + 0.07 * static_cast<double>(i));
    });
    const auto told = [&](double sign, double offset) {
        return refusal(changed(made, "bearing_rad", [=](std::size_t i, double) {
            return fmt::format(
                "{:.4f}", std::remainder(sign * (-3 + 0.07 * static_cast<double>(i)) + offset, 6.2831853));
        }));
    };
    CHECK(told(1, 0) == "");
    CHECK(told(1, 0.4) == "");
    CHECK_THAT(told(-1, 0), Contains("mirror image"));
    CHECK_THAT(told(-1, 0.4), Contains("mirror image"));
}

TEST_CASE("rows written twice are said and left out once") {
    for (const char* kind : {"proximity", "motion", "accelerometer", "microphone"}) {
        INFO(kind);
        Made made = clean(kind);
        for (std::size_t i = made.rows.size(); i-- > 0;)
            made.rows.insert(made.rows.begin() + static_cast<std::ptrdiff_t>(i), made.rows[i]);
        made.runs = 1;
        CHECK_THAT(cautions_of(made), Contains("rows repeat the row before, clock included"));
    }
}

TEST_CASE("clocks that go back, stand still, wrap or jump") {
    const auto back = [](std::size_t i, double t) { return fmt::format("{}", i > 40 ? t - 3 : t); };
    CHECK_THAT(refusal(changed(clean("motion"), "t_s", back)), Contains("goes back") && Contains("row 42"));
    CHECK_THAT(refusal(changed(clean("timing"), "t_host_s", back)), Contains("goes back"));
    CHECK_THAT(refusal(changed(clean("motion"), "t_s", [](std::size_t, double) { return "5"; })),
               Contains("stands still"));
    CHECK_THAT(
        cautions_of(changed(clean("motion"), "t_s",
                            [](std::size_t i, double t) { return fmt::format("{}", i > 40 ? t + 100 : t); })),
        Contains("jumps by"));
    CHECK_THAT(
        refusal(changed(clean("motion"), "t_s",
                        [](std::size_t i, double t) { return fmt::format("{}", i > 40 ? t + 1e9 : t); })),
        Contains("jumps by"));
    const auto wrap = [](std::size_t, double steps) {
        return fmt::format("{}", std::fmod(steps + 32000 + 32768, 65536) - 32768);
    };
    CHECK_THAT(refusal(changed(clean("motion"), "steps_left", wrap)), Contains("16-bit"));
    const auto long_wrap = [](std::size_t, double steps) {
        return fmt::format("{:.0f}", std::fmod(steps + 4294967296 - 700, 4294967296));
    };
    CHECK_THAT(refusal(changed(clean("motion"), "steps_left", long_wrap)),
               Contains("jumps by") && !Contains("16-bit"));
}

TEST_CASE("a counter that is reset is refused however long a row lasts, one that passes 0 is not") {
    const double longer = GENERATE(1.0, 2.0, 20.0);
    Made drive =
        changed(clean("motion"), "t_s", [&](std::size_t, double t) { return fmt::format("{}", longer * t); });
    for (const char* command : {"cmd_left", "cmd_right"})
        drive = changed(drive, command,
                        [&](std::size_t, double speed) { return fmt::format("{}", speed / longer); });
    const auto less = [](std::size_t row, double steps) {
        return [=](std::size_t i, double all) { return fmt::format("{}", i < row ? all : all - steps); };
    };
    CHECK_THAT(refusal(changed(drive, "steps_right", less(41, 1400))),
               Contains("run0.csv: row 42: steps_right") && Contains("was reset"));
    CHECK(refusal(changed(drive, "steps_right", less(0, 700))) == "");
}

TEST_CASE("a robot that turns back fast in one long row has no counter that was reset") {
    Made spin{"motion", {"t_s", "steps_left", "steps_right", "x_m", "y_m", "theta_rad"}, {}, "", 3};
    constexpr double kMetre = 2 * std::numbers::pi * 0.0205 / 1000;
    for (int i = 0; i < 80; ++i) {
        const double steps = 200 * (i % 20);
        spin.rows.emplace_back();
        for (const double value : {5.0 * i, -steps, steps, 1e-4 * (i % 3), 0.0, 2 * steps * kMetre / 0.053})
            spin.rows.back().push_back(fmt::format("{:.7g}", value));
    }
    CHECK(refusal(spin) == "");
}

TEST_CASE("a heading in coarse steps is in radians all the same") {
    constexpr double kStep = std::numbers::pi / 8;
    CHECK(refusal(changed(clean("motion"), "theta_rad", [](std::size_t, double theta) {
              return fmt::format("{:.7g}", kStep * std::round(theta / kStep));
          })) == "");
}

TEST_CASE("constant columns") {
    const auto always = [](const char* text) {
        return [text](std::size_t, double) { return std::string(text); };
    };
    Made same = changed(clean("accelerometer"), "ax", always("2048"));
    CHECK_THAT(refusal(same), Contains("in every row of every run"));
    CHECK_THAT(cautions_of(changed(clean("proximity"), "distance_m", always("0.03"))),
               Contains("distance_m is 0.03 m"));
    CHECK_THAT(
        refusal(changed(changed(clean("motion"), "steps_left", always("0")), "steps_right", always("0"))),
        Contains("stands still while its wheel is commanded"));
    CHECK_THAT(refusal(changed(clean("motion"), "steps_left", always("0"))),
               Contains("steps_left stands still"));
    Made still = changed(changed(clean("motion"), "x_m", always("0")), "y_m", always("0"));
    still = changed(still, "theta_rad", always("0"));
    CHECK_THAT(refusal(still), Contains("pose is the same"));
    Made floor = clean("ground");
    floor.toml = "[instrument]\nreading = { floor = 2000, ceiling = 4000 }\n";
    CHECK_THAT(refusal(floor), Contains("[instrument]"));
}

TEST_CASE("a sensor that hung in one run is said") {
    const Folder folder(clean("ground"));
    std::string csv = "t_s,sensor,grey,reading\n";
    for (int i = 0; i < 60; ++i)
        csv += fmt::format("{},{},{},500\n", i * 0.1, i % 3, i % 5 / 4.0);
    write_file(folder.path() / "run2.csv", csv);
    std::string cautions;
    CHECK(refusal(folder.path(), &cautions) == "");
    CHECK_THAT(cautions, Contains("run2.csv") && Contains("did it hang"));
}

TEST_CASE("missing cells are told once a column") {
    const Folder folder(clean("ground"));
    const auto holed = [](std::size_t every) {
        std::string csv = "t_s,sensor,grey,reading\n";
        for (std::size_t i = 0; i < 60; ++i)
            csv += fmt::format("{:.1f},{},{},{}\n", static_cast<double>(i) * 0.1, i % 3,
                               i % every == 0 ? "" : fmt::format("{}", static_cast<double>(i % 5) / 4.0),
                               331 + 155 * (i % 5) + (i * i + every) % 37);
        return csv;
    };
    write_file(folder.path() / "run2.csv", holed(20));
    std::string cautions;
    CHECK(refusal(folder.path(), &cautions) == "");
    CHECK_THAT(cautions, Contains("run2.csv: grey is missing in 3 of 60 rows, which are left out\n"));
    write_file(folder.path() / "run1.csv", holed(6));
    cautions.clear();
    CHECK(refusal(folder.path(), &cautions) == "");
    CHECK_THAT(cautions, Contains("grey is missing in 13 of 120 rows (2 runs), which are left out; most in "
                                  "run1.csv: 10 of 60\n") &&
                             !Contains(": grey is missing"));
}

TEST_CASE("missing, impossible and few values") {
    const auto gone = [](std::size_t every) {
        return
            [every](std::size_t i, double value) { return i % every == 0 ? "" : fmt::format("{}", value); };
    };
    CHECK_THAT(refusal(changed(clean("ground"), "grey", gone(1))), Contains("grey is missing in 60 of 60"));
    CHECK_THAT(cautions_of(changed(clean("ground"), "grey", gone(5))),
               Contains("grey is missing in 36 of 180 rows (3 runs), which are left out"));
    CHECK_THAT(cautions_of(changed(clean("ground"), "sensor", gone(1))),
               Contains("empty in every row of 3 runs, taken as not recorded: sensor"));
    CHECK_THAT(cautions_of(changed(clean("ground"), "sensor", gone(7))),
               Contains("sensor is missing in 27 of 180 rows (3 runs)"));
    CHECK_THAT(
        cautions_of(changed(clean("ground"), "reading",
                            [](std::size_t i, double v) { return i == 7 ? "1e300" : fmt::format("{}", v); })),
        Contains("row 8") && Contains("impossible") && Contains("taken as missing"));
    CHECK_THAT(
        refusal(changed(clean("ground"), "reading",
                        [](std::size_t i, double v) { return i == 7 ? "1e999" : fmt::format("{}", v); })),
        Contains("not a finite number"));
    CHECK_THAT(refusal(changed(clean("proximity"), "sensor", [](std::size_t, double) { return "1.5"; })),
               Contains("not whole"));
    Made few = clean("ground");
    few.rows.resize(4);
    CHECK_THAT(cautions_of(few), Contains("only 12 rows"));
    Made alone = clean("ground");
    alone.runs = 1;
    CHECK_THAT(cautions_of(alone), Contains("one run only"));
    Made blind = clean("motion");
    blind.names.back() = "other";
    CHECK_THAT(refusal(blind), Contains("theta_rad"));
    Made mixed = clean("ground");
    mixed.names.emplace_back("unit");
    for (std::size_t i = 0; i < mixed.rows.size(); ++i)
        mixed.rows[i].push_back(i % 2 == 0 ? "1" : "2");
    mixed.runs = 1;
    CHECK_THAT(cautions_of(mixed), Contains("2 robots are mixed"));
}

TEST_CASE("nominal numbers that no robot can have are refused, and doubtful units are said") {
    const auto with = [](const std::string& line) {
        Experiment experiment;
        experiment.kind = Kind::Motion;
        experiment.folder = "made";
        const auto equals = line.find('=');
        experiment.nominal[line.substr(0, equals)] = std::stod(line.substr(equals + 1));
        check_nominal(experiment);
        return experiment.cautions;
    };
    for (const char* line :
         {"firmware.agenda=2", "firmware.agenda=0.5", "firmware.start_loss=-1", "firmware.start_loss=50",
          "inverse_friction=-1", "robot.axle_length=0", "contact.mu=0.001", "wheel_scale=-1"}) {
        CAPTURE(line);
        const std::string name(line, std::string(line).find('='));
        CHECK_THROWS_WITH(with(line), Contains("experiment.toml") && Contains(name));
    }
    const auto millimetres = with("robot.axle_length=53");
    REQUIRE(millimetres.size() == 1);
    CHECK_THAT(millimetres.front(), Contains("robot.axle_length = 53 m is") && Contains("unit"));
    // The number is blamed, not the columns that do not fit it.
    Made drive = clean("motion");
    drive.toml = "[nominal]\n\"robot.steps_per_turn\" = 0\n";
    CHECK_THAT(refusal(drive), Contains("robot.steps_per_turn"));
    // Other robots than the simulator's are welcome.
    CHECK(with("robot.axle_length=0.2").empty());
    CHECK(with("inverse_friction=0").empty());
    CHECK(with("firmware.start_loss=1.1").empty());
}

TEST_CASE("nominal numbers of nothing that can be built are refused") {
    Made made = clean("ground");
    made.toml = "[nominal]\n\"ground.white\" = 1e300\n";
    const Folder folder(made);
    const Experiment experiment = read_experiment(folder.path());
    CHECK_THROWS_WITH(make_model(experiment), Contains("[nominal]"));
}

TEST_CASE("a truth that nobody measured is said, and only truth can be assumed") {
    Made made = clean("proximity");
    made.toml = "assumed = [\"distance_m\"]\n" + made.toml;
    CHECK_THAT(cautions_of(made), Contains("distance_m was not measured but assumed"));
    made.toml = "assumed = [\"reading\"]\n";
    CHECK_THAT(refusal(made), Contains("no truth"));
    made.toml = "assumed = [\"distanz\"]\n";
    CHECK_THAT(refusal(made), Contains("no truth"));
}

namespace {

/// Counters in place of steps, by `of_steps` of each; `line` states their unit.
Made logged_as(const char* unit, const char* column, double of_step) {
    Made made = clean("motion");
    made.toml = fmt::format("[columns]\n{0}_left = \"{1}\"\n{0}_right = \"{1}\"\n", column, unit);
    for (const char* side : {"_left", "_right"})
        made = scaled(made, std::string(column) + side, of_step);
    return made;
}

std::vector<double> read_column(const Made& made, const char* column) {
    const Folder folder(made);
    return read_experiment(folder.path()).runs.front().column(column);
}

}  // namespace

TEST_CASE("wheels may be logged in metres, angles and speeds") {
    const double metre = 2 * std::numbers::pi * 0.0205 / 1000, angle = 2 * std::numbers::pi / 1000;
    const std::vector<double> steps = read_column(clean("motion"), "steps_left"),
                              commands = read_column(clean("motion"), "cmd_right");
    const auto same = [](const std::vector<double>& one, const std::vector<double>& other) {
        REQUIRE(one.size() == other.size());
        for (std::size_t i = 0; i < one.size(); ++i)
            CHECK(one[i] == Approx(other[i]).margin(1e-3));
    };
    same(read_column(logged_as("m", "steps", metre), "steps_left"), steps);
    same(read_column(logged_as("mm", "steps", 1000 * metre), "steps_left"), steps);
    same(read_column(logged_as("rad", "steps", angle), "steps_left"), steps);
    same(read_column(logged_as("m/s", "cmd", metre), "cmd_right"), commands);
    same(read_column(logged_as("rad/s", "cmd", angle), "cmd_right"), commands);
    CHECK_THAT(refusal(logged_as("kg", "steps", 1)),
               Contains("steps_left cannot be in \"kg\"") && Contains("m, cm, mm"));
    CHECK_THAT(refusal(logged_as("m", "cmd", 1)), Contains("cannot be in \"m\"") && Contains("m/s"));
}

TEST_CASE("a counter that is a speed is summed over time") {
    Made made = clean("motion");
    made.toml = "[columns]\nsteps_left = \"mm/s\"\nsteps_right = \"mm/s\"\n";
    const double metre = 2 * std::numbers::pi * 0.0205 / 1000;
    const std::size_t command = place_of(made, "cmd_left");
    for (const char* side : {"left", "right"})
        made = changed(made, std::string("steps_") + side, [&](std::size_t i, double) {
            const std::string& asked = made.rows[i][command + (std::string_view(side) == "left" ? 0 : 1)];
            return fmt::format("{:.9g}", std::stod(asked) * metre * 1000);
        });
    const std::vector<double> steps = read_column(clean("motion"), "steps_right"),
                              summed = read_column(made, "steps_right");
    for (std::size_t i = 0; i < steps.size(); ++i)
        CHECK(summed[i] == Approx(steps[i]).margin(25));  // half a row at each change of speed
}

TEST_CASE("a robot that is carried is reported with its rows") {
    const Made whole = clean("motion");
    const auto carried = [&](std::size_t from, double far) {
        return changed(whole, "x_m", [&](std::size_t i, double x) {
            return fmt::format("{:.7g}", i >= from ? x + far : x);
        });
    };
    CHECK_THAT(cautions_of(whole), !Contains("without its wheels"));
    CHECK_THAT(cautions_of(carried(30, 0.01)), !Contains("without its wheels"));
    CHECK_THAT(cautions_of(carried(30, 0.3)),
               Contains("run0.csv: the robot went without its wheels 1 time: into row 31 by 0.3"));
    // Slowly, while the wheels stand.
    Made slow = whole;
    const std::size_t x = place_of(slow, "x_m"), y = place_of(slow, "y_m"),
                      theta = place_of(slow, "theta_rad"), left = place_of(slow, "steps_left"),
                      right = place_of(slow, "steps_right");
    for (std::size_t i = 50; i < slow.rows.size(); ++i) {
        for (const std::size_t column : {left, right, y, theta})
            slow.rows[i][column] = slow.rows[49][column];
        slow.rows[i][x] =
            fmt::format("{:.7g}", std::stod(slow.rows[49][x]) + 0.01 * static_cast<double>(i - 49));
        for (const char* command : {"cmd_left", "cmd_right"})
            slow.rows[i][place_of(slow, command)] = "0";
    }
    for (const char* command : {"cmd_left", "cmd_right"})
        slow.rows[49][place_of(slow, command)] = "0";
    CHECK_THAT(cautions_of(slow), Contains("rows 50 to 80 by 0.3 m"));
}
