#include "physics/robot/tuning.h"

#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace puckloop::physics {

namespace {

// Groups, and of `robot` what its drives and the floor under it go by.
constexpr std::array<std::string_view, 5> kGroups{"proximity.", "light.", "ground.", "accelerometer.",
                                                  "battery."};
constexpr std::array<std::string_view, 12> kOfRobot{
    "robot.deadband",    "robot.step_loss_speed", "robot.step_loss_width",  "robot.smoothing_limit",
    "robot.settle_time", "robot.pull_out_steps",  "robot.drive_compliance", "robot.backlash",
    "robot.turn_scrub",  "robot.slope_creep",     "robot.drift_x",          "robot.drift_y"};
// Delays have a length from the beginning; a charge is the battery's own business from then on.
constexpr std::array<std::string_view, 3> kFixed{"proximity.age", "ground.lag", "battery.charge"};

}  // namespace

std::string problem_of_tuning(std::string_view name, double value) {
    try {
        Parameters().set(name, value);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    const bool of_robot = std::find(kOfRobot.begin(), kOfRobot.end(), name) != kOfRobot.end();
    const bool of_group = std::any_of(kGroups.begin(), kGroups.end(),
                                      [&](std::string_view group) { return name.starts_with(group); });
    const bool fixed = std::find(kFixed.begin(), kFixed.end(), name) != kFixed.end();
    if (of_robot || (of_group && !fixed)) return {};
    if (name == "battery.charge") return "battery.charge is at the start (expected set ROBOT charge SHARE)";
    return fmt::format(
        "{} does not change while the run is on (expected one of proximity, light, ground, "
        "accelerometer or battery, or what a drive or the floor goes by, such as robot.drift_x)",
        name);
}

}  // namespace puckloop::physics
