#pragma once
// Wheels as laboratories log them: metres or an angle in place of steps, metres a second or an angular speed
// in place of steps a second. What a step is, the experiment's nominal numbers give.

#include "gap/data/experiment.h"

#include <string_view>

namespace puckloop::gap {

/// Is it a counter's or a command's column, and may it be in this unit besides its own?
bool is_wheel_unit(std::string_view column, std::string_view unit);
/// Units that is_wheel_unit() takes beside the column's own, in words; "" for other columns.
std::string_view wheel_units(std::string_view column);

/// Turns such a column of a run into steps, or steps a second; a counter that is a speed is summed over t_s.
void to_steps(const Experiment& experiment, Run& run, std::string_view column, std::string_view unit);

}  // namespace puckloop::gap
