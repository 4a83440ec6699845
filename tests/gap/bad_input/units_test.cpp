// Numbers in another unit than stated that stay possible: a caution names file, column, range, likely unit
// and the line of [columns] that states it.

#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;
using puckloop::RandomStream;

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

void check_no_unit(const Made& made) {
    const std::string cautions = cautions_of(made);
    for (const char* word : {"state ", "unit of", "in steps/s"})
        CHECK_THAT(cautions, !Contains(word));
}

/// `rows` of cells, each made by `row` of its number and a random stream.
Made made(const std::string& kind, std::vector<std::string> names, int rows, const std::string& columns,
          const std::function<std::vector<double>(int, RandomStream&)>& row) {
    Made all{kind, std::move(names), {}, columns.empty() ? "" : "[columns]\n" + columns + "\n", 3};
    RandomStream random(Catch::rngSeed(), "gap/bad input/units/" + kind);
    for (int i = 0; i < rows; ++i) {
        all.rows.emplace_back();
        for (const double value : row(i, random))
            all.rows.back().push_back(fmt::format("{:.7g}", value));
    }
    return all;
}

TEST_CASE("clean experiments of every kind get no caution about a unit") {
    for (const char* kind :
         {"proximity", "motion", "rab", "microphone", "ground", "accelerometer", "timing"}) {
        INFO(kind);
        check_no_unit(clean(kind));
    }
}

TEST_CASE("metres stated as millimetres or centimetres") {
    const Made wall = clean("proximity");
    CHECK_THAT(
        cautions_of(with_columns(wall, "distance_m = \"mm\"")),
        Contains("run0.csv and 2 more files: distance_m reaches 4.66e-05 m, where something from 0.0002") &&
            Contains("if the files' numbers are in m, state distance_m = \"m\" in [columns]"));
    // A hundredth is possible, but readings do not fall so within half a millimetre.
    CHECK_THAT(cautions_of(with_columns(scaled(wall, "distance_m", 4), "distance_m = \"cm\"")),
               Contains("distance_m changes 0.04") && Contains("as reading lets expect") &&
                   Contains("state distance_m = \"m\" in [columns]"));
    CHECK_THAT(cautions_of(with_columns(clean("microphone"), "distance_m = \"mm\"")),
               Contains("state distance_m = \"m\" in [columns]"));
}

TEST_CASE("millimetres and centimetres taken for each other, or not stated") {
    const Made wall = clean("proximity");
    CHECK_THAT(cautions_of(with_columns(scaled(wall, "distance_m", 1000), "distance_m = \"cm\"")),
               Contains("state distance_m = \"mm\" in [columns]"));
    CHECK_THAT(cautions_of(with_columns(scaled(wall, "distance_m", 100), "distance_m = \"mm\"")),
               Contains("state distance_m = \"cm\" in [columns]"));
    Made sound = scaled(clean("microphone"), "distance_m", 40);
    CHECK_THAT(cautions_of(sound),
               Contains("distance_m reaches 16 m, where something from 0.01 to 10 is usual") &&
                   Contains("state distance_m = \"cm\" in [columns]"));
    // The header's own name for the column is part of the line.
    sound.names[place_of(sound, "distance_m")] = "range";
    CHECK_THAT(cautions_of(with_columns(sound, "distance_m = { from = \"range\" }")),
               Contains("state distance_m = { from = \"range\", unit = \"cm\" } in [columns]"));
    // What is impossible is refused, with the line.
    CHECK_THAT(refusal(scaled(wall, "distance_m", 1000)),
               Contains("numbers in mm need distance_m = \"mm\" in [columns]"));
}

TEST_CASE("a drive whose tracked way is not what its commands ask for") {
    check_no_unit(drive(1, 1));
    CHECK_THAT(cautions_of(drive(8, 8)), Contains("times as far as the commands over t_s ask for: are "
                                                  "cmd_left, cmd_right in steps/s (a step is 0.129 mm)?"));
    const std::string small = cautions_of(with_columns(drive(100, 100), "x_m = \"mm\"\ny_m = \"mm\""));
    CHECK_THAT(small, Contains("as cmd_left, cmd_right over t_s lets expect") &&
                          Contains("state x_m = \"cm\" in [columns]") &&
                          Contains("state y_m = \"cm\" in [columns]"));
    CHECK_THAT(cautions_of(scaled(drive(1, 1), "theta_rad", 1 / 6.2831853)),
               Contains("theta_rad changes 0.159 times as much") &&
                   Contains("state theta_rad = \"turn\" in [columns]"));
}

TEST_CASE("commands and times in another unit, beside counters and beside the way alone") {
    constexpr double kMetre = 2 * 3.14159265 * 0.0205 / 1000;  // of a step
    const auto with = [](const Made& made, double of_commands, double of_times) {
        return scaled(scaled(scaled(made, "cmd_left", of_commands), "cmd_right", of_commands), "t_s",
                      of_times);
    };
    const Made counted = clean("motion"), asked = drive(1, 1);
    for (const auto& [of_commands, of_times] :
         {std::pair{kMetre, 1.0}, {100 * kMetre, 1.0}, {1.0, 1.0 / 60}, {1.0, 1000.0}}) {
        INFO(of_commands << " " << of_times);
        CHECK_THAT(
            refusal(with(counted, of_commands, of_times)),
            Contains("times as many steps as the commands over t_s ask for: wrong unit of t_s or cmd"));
        CHECK_THAT(refusal(with(asked, of_commands, of_times)),
                   Contains("times as far as the commands over t_s ask for: wrong unit of t_s"));
    }
    CHECK_THAT(refusal(with(counted, 1000 * kMetre, 1)), Contains("the counters ran 7.7"));
    CHECK_THAT(cautions_of(with(asked, 1000 * kMetre, 1)),
               Contains("the robot went 7.7") &&
                   Contains("are cmd_left, cmd_right in steps/s (a step is 0.129 mm)?"));
    check_no_unit(with(counted, 0, 1));  // the firmware drives by itself
}

TEST_CASE("a robot that is held, or does nothing of what it is asked for, is no wrong unit") {
    Made held = clean("motion");
    for (const char* name : {"cmd_left", "cmd_right", "steps_left", "steps_right"})
        held = scaled(held, name, 3);
    RandomStream random(Catch::rngSeed(), "gap/bad input/units/held");
    for (const auto& [name, noise] : {std::pair{"x_m", 2e-3}, {"y_m", 2e-3}, {"theta_rad", 0.02}})
        held = changed(held, name, [&, sd = noise](std::size_t, double) {
            return fmt::format("{:.5f}", sd * random.normal());
        });
    CHECK_THAT(refusal(held), Contains("the tracker mostly sees the robot stand while its wheels turn"));
    check_no_unit(without(without(held, "steps_left"), "steps_right"));
    Made idle = held;
    for (const char* counter : {"steps_left", "steps_right"})
        idle = changed(idle, counter, [](std::size_t, double) { return "7"; });
    check_no_unit(idle);
    Made pinned = clean("motion");  // half way through
    for (std::size_t i = pinned.rows.size() / 2; i < pinned.rows.size(); ++i)
        for (const char* name : {"x_m", "y_m", "theta_rad"})
            pinned.rows[i][place_of(pinned, name)] = fmt::format(
                "{:.5f}", std::stod(pinned.rows[39][place_of(pinned, name)]) + 1e-3 * random.normal());
    check_no_unit(pinned);
}

TEST_CASE("a drive in which slow commands move nothing, or which is held fast, is no wrong unit") {
    Made slow = drive(1, 1);
    const std::size_t left = place_of(slow, "cmd_left"), time = place_of(slow, "t_s");
    for (auto& row : slow.rows)
        row[time] = fmt::format("{:g}", std::stod(row[time]) + 60);
    const auto first = slow.rows.front();
    for (const char* speed : {"40", "300"}) {
        INFO(speed);
        Made held = slow;
        for (int i = 600; i-- > 0;) {
            auto row = first;
            row[time] = fmt::format("{:g}", i * 0.1);
            row[left] = row[left + 1] = speed;
            held.rows.insert(held.rows.begin(), row);
        }
        check_no_unit(held);
    }
}

TEST_CASE("black beside white at contact, and a lamp before a far wall, are no wrong unit") {
    for (const char* unit : {"m", "mm"}) {
        INFO(unit);
        const double per_metre = *unit == 'm' && unit[1] == 'm' ? 1000 : 1;
        const auto at_contact = [&](int i, RandomStream& random) {
            const double mm = 2.4 * random.uniform(), white = i % 2 == 0 ? 1 : 0.08;
            return std::vector{i * 0.1, mm / 1000 * per_metre,
                               std::round(white * (4095 - 392 * mm) + 8 * random.normal())};
        };
        const auto lit = [&](int i, RandomStream& random) {
            return std::vector{i * 0.11, (0.2 + 0.3 * random.uniform()) * per_metre,
                               std::round(400 * std::sin(1.17 * i) + 10 * random.normal())};
        };
        const std::vector<std::string> names{"t_s", "distance_m", "reading"};
        const std::string stated = fmt::format("distance_m = \"{}\"", unit);
        check_no_unit(made("proximity", names, 90, stated, at_contact));
        check_no_unit(made("proximity", names, 90, stated, lit));
    }
}

TEST_CASE("one bearing by several receivers, and a sender that is slow, are no wrong unit") {
    const std::vector<std::string> names{"t_s",      "distance_m", "true_bearing_rad", "bearing_rad",
                                         "receiver", "strength",   "send_period",      "arrival_rate"};
    const auto message = [](double seconds) {
        return [seconds](int i, RandomStream& random) {
            const double far = 0.1 + 0.6 * random.uniform();
            return std::vector{i * 30.0,
                               far,
                               0.5,
                               0.5 + 0.1 * random.normal(),
                               static_cast<double>(1 + i % 5),
                               std::round(2000 * std::exp(0.1 * random.normal() - far)),
                               seconds,
                               1 / seconds};
        };
    };
    check_no_unit(made("rab", names, 90, "", message(30)));
    CHECK_THAT(cautions_of(made("rab", names, 90, "t_s = \"ms\"", message(30))),
               Contains("state send_period = \"ms\" in [columns]"));
}

TEST_CASE("angles against what else shows them") {
    Made bearings = clean("rab");
    for (std::size_t i = 0; i < bearings.rows.size(); ++i)
        for (const char* name : {"true_bearing_rad", "bearing_rad"}) {
            std::string& cell = bearings.rows[i][place_of(bearings, name)];
            cell = fmt::format("{:.6g}", std::stod(cell) + 0.2 * static_cast<double>(i % 9) - 0.8);
        }
    check_no_unit(bearings);
    CHECK_THAT(cautions_of(with_columns(bearings, "true_bearing_rad = \"deg\"")),
               Contains("times as much as true_bearing_rad lets expect") &&
                   Contains("state true_bearing_rad = \"rad\" in [columns]"));
    CHECK_THAT(cautions_of(with_columns(clean("accelerometer"), "pitch_rad = \"deg\"")),
               Contains("times as much as ay lets expect") &&
                   Contains("state pitch_rad = \"rad\" in [columns]"));
}

TEST_CASE("a few tilts and pushes of a robot that is mostly at rest") {
    const auto rests = [](double pitch_per, double push_per) {
        return [=](int i, RandomStream& random) {
            const double pitch = i % 9 == 0 ? 0.17 : i % 9 == 3 ? -0.1 : 0.0, push = i % 9 == 6 ? 3.0 : 0.0;
            return std::vector{i * 0.1,
                               std::round(2048 + 8 * random.normal()),
                               std::round(2048 - 800 * (pitch + push / 9.8) + 8 * random.normal()),
                               std::round(2848 + 8 * random.normal()),
                               pitch / pitch_per,
                               push / push_per};
        };
    };
    const std::vector<std::string> names{"t_s", "ax", "ay", "az", "pitch_rad", "acceleration"};
    check_no_unit(made("accelerometer", names, 120, "", rests(1, 1)));
    CHECK_THAT(cautions_of(made("accelerometer", names, 120, "pitch_rad = \"deg\"", rests(1, 1))),
               Contains("state pitch_rad = \"rad\" in [columns]"));
    CHECK_THAT(cautions_of(made("accelerometer", names, 120, "", rests(1, 9.8))),
               Contains("state acceleration = \"g\" in [columns]"));
}

TEST_CASE("angles in radians stated as degrees") {
    CHECK_THAT(cautions_of(with_columns(clean("proximity"), "angle_rad = \"deg\"")),
               Contains("angle_rad reaches 0.00698 rad, where something from 0.028 to 1.6 is usual") &&
                   Contains("state angle_rad = \"rad\" in [columns]"));
}

TEST_CASE("a time in milliseconds or microseconds makes rows of minutes or days") {
    for (const auto& [factor, unit] : {std::pair{1e3, "ms"}, {1e6, "us"}})
        CHECK_THAT(cautions_of(scaled(clean("ground"), "t_s", factor)),
                   Contains("t_s goes on from row to row by") &&
                       Contains(fmt::format("state t_s = \"{}\"", unit)));
}

TEST_CASE("a floor driven over: slopes, speeds and times are held against what the greys do") {
    // 50 mm/s there and back over waves of 80 mm; every 20th row is somewhere else.
    const auto waves = [](const char* columns, double of_slope, double of_speed, double of_time) {
        const std::vector<std::string> names{"t_s", "grey", "grey_rate", "speed", "reading"};
        return made("ground", names, 160, columns, [=](int i, RandomStream& random) {
            const double k = 2 * std::numbers::pi / 0.08, x = 0.005 * std::abs(i % 80 - 40) + i / 20 * 0.03,
                         grey = 0.5 + 0.4 * std::sin(k * x), speed = i % 80 > 40 ? 0.05 : -0.05;
            return std::vector{0.1 * i * of_time, grey, 0.4 * k * std::cos(k * x) * of_slope,
                               speed * of_speed, std::round(330 + 620 * grey + 4 * random.normal())};
        });
    };
    check_no_unit(waves("", 1, 1, 1));
    CHECK_THAT(cautions_of(waves("", 1e-3, 1, 1)), Contains("grey_rate times speed over t_s is 0.00") &&
                                                       Contains("times the change of grey") &&
                                                       Contains("state grey_rate = \"1/mm\" in [columns]"));
    CHECK_THAT(cautions_of(waves("speed = \"cm/s\"", 1, 1, 1)),
               Contains("state speed = \"m/s\" in [columns]"));
    CHECK_THAT(cautions_of(waves("", 1, 1, 1000)), Contains("state t_s = \"ms\" in [columns]"));
}

TEST_CASE("an approach of a stage: distance, velocity and time") {
    const auto approach = [](const char* columns, double of_velocity, double of_time) {
        const std::vector<std::string> names{"t_s", "distance_m", "velocity", "reading"};
        return made("proximity", names, 120, columns, [=](int i, RandomStream& random) {
            const double far = 0.06 - 0.002 * (i % 25);
            return std::vector{0.05 * i * of_time, far, -0.04 * of_velocity,
                               std::round(3700 * std::exp(-far / 0.0125) + 20 + 4 * random.normal())};
        });
    };
    check_no_unit(approach("", 1, 1));
    CHECK_THAT(cautions_of(approach("velocity = \"cm/s\"", 1, 1)),
               Contains("velocity over t_s is 0.01 times the change of distance_m") &&
                   Contains("state velocity = \"m/s\" in [columns]"));
    CHECK_THAT(cautions_of(approach("", 1, 1000)), Contains("state t_s = \"ms\" in [columns]"));
}

TEST_CASE("messages: rates and periods") {
    const auto heard = [](const char* columns, double rate, double seconds) {
        const std::vector<std::string> names{"t_s",      "distance_m",   "senders",    "received",
                                             "strength", "arrival_rate", "send_period"};
        return made("rab", names, 90, columns, [=](int i, RandomStream& random) {
            const double far = 0.1 + 0.6 * random.uniform(), senders = 1 + i / 30;
            return std::vector{0.1 * i * seconds,
                               far,
                               senders,
                               i % 10 == 3 ? 0.0 : 1.0,
                               std::round(2000 * std::exp(0.1 * random.normal() - far)),
                               10 * senders * rate,
                               0.1};
        });
    };
    check_no_unit(heard("", 1, 1));
    CHECK_THAT(cautions_of(heard("", 1e-3, 1)), Contains("state arrival_rate = \"kHz\" in [columns]"));
    CHECK_THAT(cautions_of(heard("", 1, 1000)), Contains("state t_s = \"ms\" in [columns]"));
}

TEST_CASE("level tables, dark rooms, fast robots and what few messages are noted are taken as they are") {
    const auto with = [](Made made, const std::string& name, double value) {
        made.names.push_back(name);
        for (auto& row : made.rows)
            row.push_back(
                fmt::format("{:.7g}", value * (1 + static_cast<double>(&row - made.rows.data()) / 99)));
        return made;
    };
    check_no_unit(with(clean("motion"), "incline_rad", 0.0015));
    check_no_unit(with(with(clean("proximity"), "ambient", 0.003), "speed", 1.4));
    check_no_unit(with(clean("microphone"), "amplitude", 60));
    check_no_unit(made("rab", {"t_s", "distance_m", "received", "strength", "send_period"}, 90, "",
                       [](int i, RandomStream& random) {
                           const double far = 0.1 + 0.6 * random.uniform();
                           return std::vector{12.0 * i, far, 1.0, std::round(2000 * std::exp(-far)), 0.1};
                       }));
}
