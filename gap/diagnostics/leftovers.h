#pragma once
// What is left after the best model: the structures that chance does not explain.

#include "gap/data/experiment.h"
#include "gap/findings/findings.h"
#include "gap/models/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

/// Is an observable a step counter? The firmware makes it: whole steps have structure of their own.
inline bool is_counter(const std::string& observable) {
    return observable.starts_with("steps_");
}

/// Structures of the series' innovations after the fit that chance does not explain (corrected over all
/// observables), the surest first. A structure smaller than the step to which its observable is rounded is
/// what rounding makes.
std::vector<Leftover> leftovers_of(const Experiment& experiment, const std::vector<Observable>& observables,
                                   const std::vector<Series>& series, std::uint64_t seed);

}  // namespace puckloop::gap
