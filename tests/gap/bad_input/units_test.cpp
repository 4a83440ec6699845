// Numbers in another unit than stated that stay possible: a caution names file, column, range, likely unit
// and the line of [columns] that states it.

#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

Made with_columns(Made made, const std::string& lines) {
    made.toml += "[columns]\n" + lines + "\n";
    return made;
}

Made without(Made made, const std::string& name) {
    const auto at = static_cast<std::ptrdiff_t>(place_of(made, name));
    made.names.erase(made.names.begin() + at);
    for (auto& row : made.rows)
        row.erase(row.begin() + at);
    return made;
}

Made drive(double scale_x, double scale_y) {
    const Made made = without(without(clean("motion"), "steps_left"), "steps_right");
    return scaled(scaled(made, "x_m", scale_x), "y_m", scale_y);
}

}  // namespace

TEST_CASE("clean experiments of every kind get no caution about a unit") {
    for (const char* kind :
         {"proximity", "motion", "rab", "microphone", "ground", "accelerometer", "timing"}) {
        INFO(kind);
        const std::string cautions = cautions_of(clean(kind));
        for (const char* word : {"state ", "unit of", "its unit", "usually"})
            CHECK_THAT(cautions, !Contains(word));
    }
}

TEST_CASE("metres stated as millimetres or centimetres") {
    const Made wall = clean("proximity");
    CHECK_THAT(
        cautions_of(with_columns(wall, "distance_m = \"mm\"")),
        Contains("run0.csv and 2 more files: distance_m is 1e-05 to 4.8e-05 m; usually it reaches 0.001 m") &&
            Contains("if the files' numbers are in m, state distance_m = \"m\" in [columns]"));
    // A hundredth is possible, but readings do not fall so within half a millimetre.
    CHECK_THAT(cautions_of(with_columns(scaled(wall, "distance_m", 4), "distance_m = \"cm\"")),
               Contains("next to contact") && Contains("state distance_m = \"m\" in [columns]"));
    CHECK_THAT(cautions_of(with_columns(clean("microphone"), "distance_m = \"mm\"")),
               Contains("state distance_m = \"m\" in [columns]"));
}

TEST_CASE("centimetres and millimetres that nobody stated") {
    Made wall = scaled(clean("proximity"), "distance_m", 10);
    CHECK_THAT(cautions_of(wall), Contains("readings differ by") && Contains("see next to nothing"));
    Made sound = scaled(clean("microphone"), "distance_m", 40);
    CHECK_THAT(cautions_of(sound), Contains("distance_m is 4 to 16 m; usually some of it is 3 m or less") &&
                                       Contains("state distance_m = \"cm\" in [columns]"));
    // The header's own name for the column is part of the line.
    sound.names[place_of(sound, "distance_m")] = "range";
    CHECK_THAT(cautions_of(with_columns(sound, "distance_m = { from = \"range\" }")),
               Contains("state distance_m = { from = \"range\", unit = \"cm\" } in [columns]"));
    // What is impossible is refused, with the line.
    CHECK_THAT(refusal(scaled(clean("proximity"), "distance_m", 1000)),
               Contains("numbers in mm need distance_m = \"mm\" in [columns]"));
}

TEST_CASE("a drive whose tracked way is not what its commands ask for") {
    CHECK_THAT(cautions_of(drive(1, 1)), !Contains("times as far"));
    const std::string ten = cautions_of(drive(10, 10));
    CHECK_THAT(ten,
               Contains("by x_m and y_m the robot went 10 times as far as the commands over t_s ask for"));
    CHECK_THAT(cautions_of(with_columns(drive(100, 100), "x_m = \"mm\"\ny_m = \"mm\"")),
               Contains("the robot went 0.1 times as far") &&
                   Contains("state x_m = \"cm\", y_m = \"cm\" in [columns]"));
    CHECK_THAT(cautions_of(scaled(drive(1, 1), "theta_rad", 1 / 6.2831853)),
               Contains("theta_rad turns 0.159 times as far") &&
                   Contains("state theta_rad = \"turn\" in [columns]"));
}

TEST_CASE("a drive in which slow commands move nothing is no wrong unit") {
    Made slow = drive(1, 1);
    const std::size_t left = place_of(slow, "cmd_left"), time = place_of(slow, "t_s");
    for (auto& row : slow.rows)
        row[time] = fmt::format("{:g}", std::stod(row[time]) + 6);
    const auto first = slow.rows.front();
    for (int i = 60; i-- > 0;) {  // 40 steps/s, and the robot stands
        auto row = first;
        row[time] = fmt::format("{:g}", i * 0.1);
        row[left] = row[left + 1] = "40";
        slow.rows.insert(slow.rows.begin(), row);
    }
    CHECK_THAT(cautions_of(slow), !Contains("times as far"));
}

TEST_CASE("angles against what else shows them") {
    Made bearings = clean("rab");
    for (std::size_t i = 0; i < bearings.rows.size(); ++i)
        for (const char* name : {"true_bearing_rad", "bearing_rad"}) {
            std::string& cell = bearings.rows[i][place_of(bearings, name)];
            cell = fmt::format("{:.6g}", std::stod(cell) + 0.2 * static_cast<double>(i % 9) - 0.8);
        }
    CHECK_THAT(cautions_of(bearings), !Contains("state "));
    CHECK_THAT(cautions_of(with_columns(bearings, "true_bearing_rad = \"deg\"")),
               Contains("times as much as true_bearing_rad") &&
                   Contains("state true_bearing_rad = \"rad\" in [columns]"));
    CHECK_THAT(cautions_of(with_columns(clean("accelerometer"), "pitch_rad = \"deg\"")),
               Contains("counts a g by pitch_rad, not by some 800") &&
                   Contains("state pitch_rad = \"rad\" in [columns]"));
}

TEST_CASE("a time in microseconds makes a run of weeks") {
    CHECK_THAT(cautions_of(scaled(clean("ground"), "t_s", 1e6)),
               Contains("t_s goes on for") && Contains("days in one run") && Contains("state t_s = \"us\""));
}
