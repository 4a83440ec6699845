#include "gap/pipeline/diagnose.h"

#include "gap/decide/thresholds.h"
#include "gap/diagnostics/leftovers.h"
#include "gap/diagnostics/series.h"
#include "gap/fit_test/wander.h"
#include "gap/residual_model/free_form.h"
#include "gap/validate/placements.h"

#include <algorithm>

namespace puckloop::gap {

namespace {

/// Offsets of placements say more than that rows carry over.
void name_placements(const Experiment& experiment, Diagnosis& found) {
    for (const Series& series : found.series) {
        const std::string shape = placement_shape(experiment, series);
        if (shape.empty()) continue;
        const auto serial =
            std::find_if(found.leftovers.begin(), found.leftovers.end(), [&](const Leftover& one) {
                return one.observable == series.observable && one.covariate == "previous sample";
            });
        if (serial == found.leftovers.end()) continue;
        serial->covariate = kPlacementCovariate;
        serial->shape = shape;
    }
}

}  // namespace

Diagnosis diagnosed(const Study& study, const Chosen& chosen, std::uint64_t seed) {
    const State &before = chosen.selection.none.fitted.state, &after = chosen.final.fitted.state;
    Diagnosis found;
    found.series = series_of(study.model(), before, after);
    std::vector<double> quanta;
    for (const Observable& observable : study.model().observables())
        quanta.push_back(observable.instrument.quantum);
    found.leftovers = leftovers_of(study.experiment(), found.series, quanta, seed, thresholds::kReported);
    name_placements(study.experiment(), found);
    found.free_forms = free_forms_of(study.experiment(), study.model(), after, seed);
    found.by_runs = left_by_runs(study, after);
    // Are the forms of the chosen effects told from their neighbours'?
    for (const Trial& step : chosen.selection.steps)
        found.forms.emplace_back(step.effect,
                                 form_verdict(rival_forms(study, chosen.selection.chosen, step.effect)));
    found.structures = found.leftovers;
    const Selection& selection = chosen.selection;
    for (const auto& more :
         {found.by_runs.structures, wandering(study, selection.chosen, thresholds::kReported)})
        found.leftovers.insert(found.leftovers.end(), more.begin(), more.end());
    std::stable_sort(found.leftovers.begin(), found.leftovers.end(),
                     [](const auto& a, const auto& b) { return a.p_value < b.p_value; });
    return found;
}

}  // namespace puckloop::gap
