#pragma once
// What the chosen effects gain on rows that were not fitted: errors and log scores before and after, with
// intervals over blocks.

#include "gap/findings/findings.h"
#include "gap/fit/select.h"
#include "gap/fit/study.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

struct HeldFigures {
    Held all;  ///< errors in units of the noise; whether a gain is claimed, and how it is put, is for others
    std::vector<HeldObservable> observables;
};

/// Errors before and after, from the squares of each block and how many rows there are, and their ratio with
/// a 90 % interval over blocks.
void compare_errors(const std::vector<double>& before, const std::vector<double>& after, double rows,
                    std::uint64_t seed, HeldObservable& to);

/// Of the chosen causes over the simulator as it is, each fitted to all rows but those it is judged by, noise
/// and all. `seed` of the bootstrap over blocks.
HeldFigures held_figures(const Study& study, const Selection& selection, std::uint64_t seed);

}  // namespace puckloop::gap
