#include "gap/decide/decide.h"

#include "gap/decide/thresholds.h"
#include "gap/evidence/criterion.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::gap {

double Grounds::left() const {
    return std::max(left_by_shape, 0.0) + std::max({left_by_run, left_by_jump, 0.0});
}

double Grounds::unexplained() const {
    const double rest = left(), won = std::max(gain.sum, 0.0);
    return rest > 0 ? rest / (rest + won) : 0.0;
}

std::string doubt_of(const Grounds& g) {
    if (g.causes == 0) return "";
    // 1. Evidence. The set as a whole must gain on runs that were not fitted; else no gain could be claimed
    //    beside its name.
    if (!gains_enough(g.gain, g.candidates, g.causes))
        return "does not gain for sure on runs that were not fitted";
    if (!g.error_falls) return "lowers the error of so few runs by chance only, as far as they tell";
    // 2. Identification. What was assumed may itself be what is wrong.
    if (!g.assumed.empty())
        return fmt::format("{} was assumed, not measured, and an error of it may look the same", g.assumed);
    // 3. Goodness of fit. What is left must be a small part of what was wrong.
    const double readings = g.left_of_readings / std::max(g.left_of_readings + g.gain.sum, 1e-9);
    if (g.unexplained() > (g.sums ? thresholds::kShareLeftOfSums : thresholds::kShareLeft) ||
        readings > thresholds::kShareLeft)
        return "leaves too much to be the cause";
    if (g.stopped_at_end && g.structure)
        return "stopped at the end of its plausible range and leaves something";
    // 4. Role. A cause gains by what it is said to do: means by means, scatter by what is scatter.
    if (!g.out_of_role.empty()) return g.out_of_role;
    // 5. Confirmation, on runs that had no part in it.
    return g.not_confirmed;
}

Decision decision_of(const Grounds& g, const std::string& doubt) {
    if (g.causes > 0 && doubt.empty()) return g.rival ? Decision::CannotTell : Decision::Named;
    // Something is wrong where a structure is sure, or where the causes that were doubted gained for sure.
    const bool wrong =
        g.structure || (g.causes > 0 && g.error_falls && gains_enough(g.gain, g.candidates, g.causes));
    return wrong ? Decision::Unexplained : Decision::NoEffect;
}

}  // namespace puckloop::gap
