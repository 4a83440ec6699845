#pragma once
// The free-form residual model: what is left after the named effects, as step functions over covariates,
// their pairs, what they were lately, and the place in the run. It comes last, is reported as unexplained,
// and names nothing.

#include "gap/findings/findings.h"
#include "gap/fit/fit.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace puckloop::gap {

/// One for each observable that can be corrected (x and y of a track together), those that gain most first.
/// Errors are those of `model` at `state`; nothing is taken away from the model's own effects. `only`: names
/// of the observables asked for, all of them if empty.
std::vector<FreeForm> free_forms_of(const Experiment& experiment, const Model& model, const State& state,
                                    std::uint64_t seed, std::span<const std::string> only = {});

}  // namespace puckloop::gap
