#pragma once
// A tracker that loses its place for some rows jumps there and back, and so does whoever lifts a robot and
// puts it where its wheels would have brought it. What takes the whole pose back is no push.

#include "gap/data/experiment.h"
#include "gap/fit/fit.h"
#include "gap/models/model.h"

#include <cstddef>
#include <vector>

namespace puckloop::gap {

/// ln of how much likelier pushes are where some take one before them in their run back than where each goes
/// any way, by the law that the fit found for them or a wider one. Where they go any way the expectation of
/// the ratio is at most 1 (an e-value: Wasserman, Ramdas and Balakrishnan 2020), so that exp(-this) is at
/// least a p value. Nothing is proved of pushes of which only some turn the robot, or that barely show: of
/// 400 drives drawn by each of such laws at most one in 300 had a ratio beyond 20. `pushed`: their rows in
/// the sums of the model, which begin with two of place and one of the heading, rising.
double taken_back(const Experiment& experiment, const Model& model, const State& state,
                  const std::vector<std::size_t>& pushed);

}  // namespace puckloop::gap
