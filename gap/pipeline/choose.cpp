#include "gap/pipeline/choose.h"

#include "gap/evidence/thresholds.h"
#include "gap/fit/intervals.h"
#include "gap/stats/series.h"

#include <cmath>

namespace puckloop::gap {

namespace {

/// Are two freed parameters one number for this data?
bool any_is_fixed_by_another(const Study& study, const Fit& fit) {
    const Precision precision = precision_of(study, fit);
    for (std::size_t j = 0; j < fit.freed.size(); ++j)
        for (std::size_t k = 0; k < j; ++k)
            if (std::abs(precision.correlation(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k))) >
                thresholds::kOneNumber)
                return true;
    return false;
}

}  // namespace

Chosen chosen_of(const Study& study, Selection selection) {
    Chosen chosen{std::move(selection), {}};
    Fit& fit = chosen.final = chosen.selection.chosen;
    if (fit.effects.empty()) return chosen;
    for (std::size_t i = 0; i < study.candidates().size(); ++i) {
        const Candidate& candidate = study.candidates()[i];
        if (!candidate.effect->fitted_along || !candidate.remark.empty() || stats::contains(fit.effects, i))
            continue;
        auto set = fit.effects;
        set.push_back(i);
        Fit wider = study.fit_set(set, fit.fitted.state);
        if (!any_is_fixed_by_another(study, wider)) fit = std::move(wider);
    }
    return chosen;
}

}  // namespace puckloop::gap
