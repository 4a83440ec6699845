#pragma once
// Pushes come by chance: when, where and which way has nothing to do with the robot, nor with the push
// before; and it shows in which rows they were. What keeps to a place, to a command, to some runs or to a
// direction, goes back as it came, or shows in no row for sure is no push, but something the model lacks that
// a jump imitates.

#include "gap/data/experiment.h"
#include "gap/diagnostics/push_directions.h"
#include "gap/fit/fit.h"
#include "gap/models/model.h"

#include <optional>

namespace puckloop::gap {

/// Nothing when the pushes that the fit finds come by chance, or when there are none; else the pattern, its p
/// corrected for every place that was looked at.
std::optional<PushPattern> push_pattern(const Experiment& experiment, const Model& model, const State& state);

}  // namespace puckloop::gap
