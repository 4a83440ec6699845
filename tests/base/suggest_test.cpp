#include "base/text/suggest.h"

#include <catch2/catch.hpp>

using namespace puckloop;

TEST_CASE("Edit distance counts single changes and ignores case") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("abc", "ABC") == 0);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("", "four") == 4);
    CHECK(edit_distance("mvo", "mov") == 1);
}

TEST_CASE("The nearest name is near, or there is none") {
    const std::vector<std::string_view> known{"seed", "speed", "world"};
    CHECK(nearest_name("sped", known) == "seed");
    CHECK(nearest_name("wrold", known) == "world");
    CHECK(nearest_name("banana", known).empty());
    CHECK(nearest_name("se", known).empty());
}

TEST_CASE("Suggestions are the nearest names, at most three, and none where none is near") {
    const std::vector<std::string_view> known{"robot.axle_length",
                                              "robot.wheel_radius_left",
                                              "robot.wheel_radius_right",
                                              "proximity.gain",
                                              "proximity.gain0",
                                              "proximity.noise",
                                              "theta_rad",
                                              "x_m",
                                              "y_m",
                                              "reading",
                                              "pair_reading",
                                              "uart.loss"};
    using Names = std::vector<std::string>;
    const std::pair<const char*, Names> typos[] = {
        {"robot.axle_lenght", {"robot.axle_length"}},
        {"robot.wheel_raduis_lft", {"robot.wheel_radius_left"}},
        {"Robot.Axle_Length", {"robot.axle_length"}},
        {"proximity.gian", {"proximity.gain"}},
        {"axle_length", {"robot.axle_length"}},
        {"theta", {"theta_rad"}},
        {"raeding", {"reading"}},
        {"z_m", {"x_m", "y_m"}},
        {"uart.los", {"uart.loss"}},
        {"robot.wheel_radius", {"robot.wheel_radius_left", "robot.wheel_radius_right"}},
        {"robot.colour", {}},
        {"", {}},
    };
    for (const auto& [typo, meant] : typos) {
        INFO(typo);
        CHECK(near_names(typo, known) == meant);
    }
    CHECK(did_you_mean("z_m", known) == "; did you mean \"x_m\" or \"y_m\"?");
    CHECK(did_you_mean("sensor9", {"sensor1", "sensor2", "sensor3", "sensor4"}) ==
          "; did you mean \"sensor1\", \"sensor2\" or \"sensor3\"?");
    CHECK(did_you_mean("banana", known).empty());
}
