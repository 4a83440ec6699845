#pragma once
// Pushes come by chance: when, where and which way has nothing to do with the robot, nor with the push
// before; and it shows in which rows they were. What keeps to a place, to a command, to some runs or to a
// direction, goes back as it came, or shows in no row for sure is no push, but something the model lacks that
// a jump imitates.

#include "gap/data/experiment.h"
#include "gap/fit/fit.h"
#include "gap/models/model.h"

#include <optional>
#include <string>

namespace puckloop::gap {

/// Most of the pushes lie where few should.
struct PushPattern {
    std::string where;      ///< "position x 0.4", "cmd left -400, cmd left in the previous row 400", "some
                            ///< runs", "rows that were as likely not pushed", or a direction
    double pushes = 0.0;    ///< there, each by its probability
    double all = 0.0;       ///< pushes found anywhere
    double expected = 0.0;  ///< there, if they came by chance
    double p_value = 1.0;   ///< of so many there by chance, corrected for every place that was looked at
};

/// Nothing when the pushes that the fit finds come by chance, or when there are none.
std::optional<PushPattern> push_pattern(const Experiment& experiment, const Model& model, const State& state);

}  // namespace puckloop::gap
