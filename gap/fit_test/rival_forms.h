#pragma once
// Rival forms: is an effect's own form told from its neighbours by the data? What an effect does to each row
// (of sums: to each row's gain) is bent: its root, its square, with a soft end, only beyond a threshold, a
// row later, growing or dying away through the run. Each bent form gets an amplitude of its own and takes the
// effect's place.

#include "gap/fit/study.h"

#include <string>
#include <vector>

namespace puckloop::gap {

struct RivalForm {
    std::string form;  ///< in words: "its root"
    Gain gain;         ///< of the effect's own form over this one, nats over blocks of runs
};

/// The forms that differ from the effect's own in these rows; none for an effect that moves no mean
/// by itself.
std::vector<RivalForm> rival_forms(const Study& study, const Fit& fit, std::size_t effect);

/// What they say of an effect.
struct FormVerdict {
    std::vector<std::string> open;  ///< forms that are not told apart
    std::string better;             ///< one that does better for sure; empty: none
    double left = 0.0;              ///< nats by which it does
};
FormVerdict form_verdict(const std::vector<RivalForm>& forms);

}  // namespace puckloop::gap
