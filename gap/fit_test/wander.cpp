#include "gap/fit_test/wander.h"

#include "gap/evidence/criterion.h"
#include "gap/evidence/thresholds.h"
#include "gap/findings/quantities.h"
#include "gap/fit/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::gap {

namespace {

constexpr int kDrift = 1;                                   // of the noise's numbers (noise.h)
constexpr Effort kCalm{.iterations = 40, .wander = false};  // to the end, nothing let wander
constexpr Effort kCalmAgain{.iterations = 12, .wander = false};

/// The fit again, with nothing let wander.
Fit calmed(const Study& study, const Fit& fit) {
    State state = fit.fitted.state;
    for (std::size_t o = 0; o < state.noise.size(); ++o) {
        if (study.model().observables()[o].steady)
            state.noise[o].carry = noise_bounds(NoiseKind::Level, kDrift).first;
    }
    for (const Nuisance& one : study.model().nuisances())
        if (one.wanders) state.values[one.index] = one.high;
    Fit calm = fit;
    calm.fitted = gap::fit(study.model(), fit.freed, state, {}, kCalm);
    return calm;
}

/// One odd run makes no structure; several do, though the others have nothing to gain by it.
bool is_clear(const Gain& gain) {
    return gain.sum > thresholds::kFormErrors * gain.sd || gain.in_several();
}

}  // namespace

std::vector<Leftover> wandering(const Study& study, const Fit& fit) {
    const auto& observables = study.model().observables();
    const auto steady = std::ranges::count_if(observables, [](const Observable& one) { return one.steady; });
    std::vector<Leftover> all;
    if (steady == 0) return all;
    // How much sums may wander is learnt from the other runs, too: else it would have seen what it predicts.
    const HeldOut held = study.hold_out(fit, kHeldOut), calm = study.hold_out(calmed(study, fit), kCalmAgain);
    for (std::size_t o = 0; o < observables.size(); ++o) {
        if (!observables[o].steady) continue;
        const Gain gain = study.gain(calm, held, o);
        const double p = std::clamp(static_cast<double>(steady) * std::exp(-gain.sum),
                                    std::numeric_limits<double>::min(), 1.0);
        if (p >= thresholds::kReported || !is_clear(gain)) continue;
        const NoiseParameters& noise = fit.fitted.state.noise[o];
        all.push_back({observables[o].name, kWanderCovariate, p,
                       fmt::format("wanders by {} a row beside what was measured",
                                   quantity(std::exp(noise.log_sd + noise.carry / 2), observables[o].unit))});
    }
    return all;
}

}  // namespace puckloop::gap
