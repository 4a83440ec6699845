#pragma once
// What is left after the best model: the structures that chance does not explain.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

/// Is an observable a step counter? The firmware makes it: whole steps have structure of their own.
inline bool is_counter(const std::string& observable) {
    return observable.starts_with("steps_");
}

/// Structures of the series' innovations after the fit that chance does not explain (corrected over all
/// observables) at `level`, the surest first. `quanta`: the step to which each observable is rounded; a
/// structure smaller than it is what rounding makes.
std::vector<Leftover> leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
                                   const std::vector<double>& quanta, std::uint64_t seed, double level);

}  // namespace puckloop::gap
