#include "gap/data/wheel_units.h"

#include "gap/kinds/columns.h"
#include "physics/description/robot_constants.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

namespace puckloop::gap {

namespace {

constexpr std::string_view kPerSecond = "/s";

bool is_counter(std::string_view column) {
    return column == "steps_left" || column == "steps_right";
}
bool is_command(std::string_view column) {
    return column == "cmd_left" || column == "cmd_right";
}

/// Of a length or an angle, or of either in a second.
struct WheelUnit {
    double factor = 1.0;  ///< to m or rad, a second or not
    bool angle = false, speed = false;
};

std::optional<WheelUnit> wheel_unit_of(std::string_view unit) {
    WheelUnit one;
    one.speed = unit.ends_with(kPerSecond);
    if (one.speed) unit.remove_suffix(kPerSecond.size());
    for (const std::string_view si : {"m", "rad"})
        if (const auto to_si = unit_to_si(unit, si)) {
            one.factor = to_si->factor;
            one.angle = si == "rad";
            return one;
        }
    return std::nullopt;
}

}  // namespace

std::string_view wheel_units(std::string_view column) {
    if (is_counter(column)) return "m, cm, mm, rad, deg, turn (a counter that is a speed: m/s, rad/s, ...)";
    return is_command(column) ? "m/s, cm/s, mm/s, rad/s, deg/s, turn/s" : "";
}

bool is_wheel_unit(std::string_view column, std::string_view unit) {
    const auto one = wheel_unit_of(unit);
    return one && (is_counter(column) || (is_command(column) && one->speed));
}

void to_steps(const Experiment& experiment, Run& run, std::string_view column, std::string_view unit) {
    const WheelUnit one = wheel_unit_of(unit).value();
    const std::string side(column.substr(column.find('_') + 1));
    const double turn = one.angle
                            ? 2 * std::numbers::pi
                            : 2 * std::numbers::pi *
                                  experiment.nominal_or("robot.wheel_radius_" + side, physics::kWheelRadius),
                 steps = one.factor * experiment.nominal_or("robot.steps_per_turn", physics::kStepsPerTurn) /
                         turn;
    std::vector<double>& values = run.columns.find(column)->second;
    for (double& value : values)
        value *= steps;
    if (!one.speed || !is_counter(column)) return;
    // Between two rows the wheel went at the mean of what was read in both.
    const std::vector<double>& time = run.column("t_s");
    double sum = 0.0, speed = NAN, last = NAN;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double now = values[i];
        if (std::isnan(now) || i >= time.size() || std::isnan(time[i])) {
            values[i] = NAN;
            continue;
        }
        if (!std::isnan(speed)) sum += (speed + now) / 2 * (time[i] - last);
        speed = now;
        last = time[i];
        values[i] = sum;
    }
}

}  // namespace puckloop::gap
