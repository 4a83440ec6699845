#include "gap/decide/decide.h"

#include "gap/evidence/thresholds.h"

#include <algorithm>

namespace puckloop::gap {

namespace {
double share_of(double left, double won) {
    return left > 0 ? left / (left + std::max(won, 0.0)) : 0.0;
}
}  // namespace

double Grounds::left() const {
    return std::max({left_by_shape, left_by_form, left_by_structure, 0.0}) + std::max(left_by_run, 0.0);
}

double Grounds::unexplained() const {
    return share_of(left(), gain.sum);
}

std::string doubt_of(const Grounds& g) {
    if (g.causes == 0) return "";
    // 1. Evidence. The set as a whole must gain on runs that were not fitted; else no gain could be claimed
    //    beside its name.
    if (!gains_enough(g.gain, g.candidates, g.causes))
        return "does not gain for sure on runs that were not fitted";
    if (!g.error_falls) return "lowers the error of so few runs by chance only, as far as they tell";
    if (g.in_rounding) return "moves readings by no more than their rounding or cutting off";
    // 2. Identification. What was assumed may itself be what is wrong.
    if (!g.assumed.empty())
        return g.assumed + " was assumed, not measured, and an error of it may look the same";
    // 3. Goodness of fit. What is left must be a small part of what was wrong.
    const double most = g.sums ? thresholds::kShareLeftOfSums : thresholds::kShareLeft;
    if (g.unexplained() > most || share_of(g.left_of_readings, g.gain.sum) > thresholds::kShareLeft)
        return "leaves too much to be the cause";
    if (g.stopped_at_end && g.structure && !g.only_wanders)
        return "stopped at the end of its plausible range and leaves something";
    // 4. Identification by these data: its numbers must be theirs, not those of their noise.
    if (!g.not_identified.empty()) return g.not_identified;
    // 5. Role: a cause gains by what it is said to do, means by means, scatter by what is scatter.
    // 6. Confirmation, on runs that had no part in it.
    return g.out_of_role.empty() ? g.not_confirmed : g.out_of_role;
}

Decision decision_of(const Grounds& g, const std::string& doubt) {
    if (g.causes > 0 && doubt.empty()) return g.rival ? Decision::CannotTell : Decision::Named;
    if (g.causes > 0 && !doubt.empty() && doubt == g.not_identified) return Decision::NotIdentifiable;
    // Something is wrong where a structure is sure, or where the causes that were doubted gained for sure
    // what is not the errors' own law.
    const bool gained = g.causes > 0 && g.error_falls && !g.law_alone && !g.in_rounding;
    const bool wrong = g.structure || (gained && gains_enough(g.gain, g.candidates, g.causes));
    return wrong ? Decision::Unexplained : Decision::NoEffect;
}

}  // namespace puckloop::gap
