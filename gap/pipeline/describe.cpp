#include "gap/pipeline/describe.h"

#include "gap/decide/decide.h"
#include "gap/diagnostics/heldout.h"
#include "gap/evidence/thresholds.h"
#include "gap/extension/extend.h"
#include "gap/fit/intervals.h"
#include "gap/kinds/description.h"
#include "gap/next_experiment/suggest.h"
#include "gap/overlay/overlay_parts.h"
#include "gap/pipeline/weigh.h"
#include "gap/predictive/check.h"
#include "gap/stats/tails.h"
#include "gap/validate/placements.h"
#include "gap/verdict/sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

using Forms = std::vector<std::pair<std::size_t, FormVerdict>>;

constexpr double kInterval = 1.645;  // standard errors of a 90 % interval
constexpr double kNothing = 1e-6;    // of the interval

const Effect& effect_of(const Study& study, std::size_t candidate) {
    return *study.candidates()[candidate].effect;
}

FittedParameter parameter_of(const Study& study, const Fit& fit, const Precision& precision, std::size_t j) {
    const auto index = fit.freed[j].index;
    const ModelParameter& parameter = study.model().parameters()[index];
    const Interval interval = interval_of(study, fit, precision, j);
    // A value that the solver left beside nothing, far below what the data could show, is nothing.
    const double value = fit.fitted.state.values[index], off = std::abs(value - parameter.neutral);
    const bool nothing = off < kNothing * (interval.high - interval.low);
    return {parameter.name, parameter.unit,    nothing ? parameter.neutral : value, interval.low,
            interval.high,  parameter.neutral, overlay_takes(parameter.name),       interval.as_likely};
}

Cause cause_of(const Study& study, const Fit& fit, const Precision& precision, std::size_t candidate,
               const Forms& forms) {
    const Effect& own = effect_of(study, candidate);
    Cause cause;
    cause.name = own.name;
    cause.number = own.number;
    cause.title = own.title;
    for (const Freed& freed : study.candidates()[candidate].freed)
        for (std::size_t j = 0; j < fit.freed.size(); ++j)
            if (fit.freed[j].index == freed.index)
                cause.parameters.push_back(parameter_of(study, fit, precision, j));
    const auto form = std::ranges::find_if(forms, [&](const auto& one) { return one.first == candidate; });
    if (form != forms.end()) cause.form = form_words(form->second);
    cause.sentence = cause_sentence(cause);
    return cause;
}

std::vector<Cause> causes_of(const Study& study, const Chosen& chosen, const Precision& precision,
                             const Forms& forms) {
    std::vector<Cause> causes;
    for (const Trial& step : chosen.selection.steps) {
        Cause cause = cause_of(study, chosen.final, precision, step.effect, forms);
        cause.evidence = step.delta_bic;
        cause.score_gain = step.held.sum;
        cause.score_low = step.held.sum - kInterval * step.held.sd;
        cause.score_high = step.held.sum + kInterval * step.held.sd;
        causes.push_back(std::move(cause));
    }
    return causes;
}

void add_ends_of_range(const Study& study, const Fit& fit, Verdict& verdict) {
    for (const Freed& freed : fit.freed) {
        const double edge = end_of_range(study, fit, freed);
        if (std::isnan(edge)) continue;
        const ModelParameter& parameter = study.model().parameters()[freed.index];
        verdict.cautions.push_back(fmt::format("{} stands at the end of its plausible range ({}): it was "
                                               "stopped there, so its value and its cause are doubtful",
                                               parameter.name, quantity(edge, parameter.unit)));
    }
}

/// A later cause whose intervals hold what the simulator has says nothing for sure: what could stand in its
/// place does not make a clear first cause doubtful.
void pass_over_empty(Verdict& verdict) {
    for (std::size_t k = 1; k < verdict.causes.size(); ++k) {
        const Cause& cause = verdict.causes[k];
        if (!std::ranges::all_of(cause.parameters,
                                 [](const auto& p) { return p.low <= p.neutral && p.neutral <= p.high; }))
            continue;
        verdict.cautions.push_back(
            fmt::format("{}: its interval holds the simulator's value, so it may be none", cause.name));
        std::erase_if(verdict.rivals, [&](const Rival& rival) { return rival.instead_of == cause.name; });
    }
}

void add_causes(const Study& study, const Judged& judged, Verdict& verdict) {
    const Selection& selection = judged.chosen.selection;
    const Fit& final = judged.chosen.final;
    const Forms& forms = judged.diagnosis.forms;
    const Precision precision = precision_of(study, final);
    verdict.causes = causes_of(study, judged.chosen, precision, forms);
    add_ends_of_range(study, final, verdict);
    for (std::size_t k = selection.chosen.effects.size(); k < final.effects.size(); ++k)
        for (const auto& parameter : cause_of(study, final, precision, final.effects[k], forms).parameters)
            verdict.nuisance.push_back(parameter);
    for (const Draw& draw : selection.draws) {
        Rival rival;
        rival.cause = cause_of(study, draw.fit, precision_of(study, draw.fit), draw.rival, forms);
        rival.instead_of = effect_of(study, draw.chosen).name;
        rival.delta_bic = draw.delta_bic;
        rival.separated_by = effect_of(study, draw.chosen).separated_by;
        rival.cause.evidence = selection.none.bic - draw.fit.bic;
        rival.cause.score_gain = -draw.held.sum;
        verdict.rivals.push_back(std::move(rival));
    }
    pass_over_empty(verdict);
}

/// What is no effect of the catalogue and is taken for one.
void add_mistaken(const Study& study, const Judged& judged, Verdict& verdict) {
    for (const std::size_t effect : judged.chosen.selection.chosen.effects)
        if (const char* mistaken = effect_of(study, effect).mistaken; mistaken != nullptr)
            verdict.cautions.push_back(fmt::format("{}: {}", effect_of(study, effect).name, mistaken));
}

/// What no run can take, once for all of it.
void add_without_place(const Study& study, Verdict& verdict) {
    const Description* own = study.experiment().kind.description();
    if (own == nullptr || verdict.causes.empty()) return;
    verdict.cautions.push_back(
        fmt::format("the simulator has no {}: overlay.toml keeps what is named under [measurement], which a "
                    "run passes over; put the values into [nominal], or into {}",
                    own->name, own->file.filename().string()));
}

void add_tried(const Study& study, const Selection& selection, Verdict& verdict) {
    for (const Trial& trial : selection.trials) {
        const Effect& own = effect_of(study, trial.effect);
        Tried tried{own.name, own.number, trial.delta_bic, trial.held.sum, 1.0, plain_remark(trial.remark)};
        if (!study.candidates()[trial.effect].remark.empty())
            tried.delta_bic = tried.score_gain = tried.p_value = NAN;  // not tried
        if (trial.validated && trial.held.sd > 0)
            tried.p_value = stats::normal_tail(trial.held.sum / trial.held.sd);
        if (fit_failed(trial.delta_bic, study.candidates()[trial.effect].freed.size(), study.rows())) {
            tried.delta_bic = NAN;
            tried.remark = "the fit failed: it ended below the model without this effect";
        }
        for (std::size_t k = 0; k < selection.steps.size(); ++k)
            if (selection.steps[k].effect == trial.effect)
                tried.remark = fmt::format("chosen, step {}", k + 1);
        verdict.tried.push_back(std::move(tried));
    }
}

/// What fits best where few runs show it, and so gains nothing on runs that were not fitted.
void add_few_runs_caution(const Study& study, const Selection& selection, Verdict& verdict) {
    if (verdict.decision != Decision::Unexplained || !verdict.nearest.empty()) return;
    const auto best = std::ranges::max_element(selection.trials, {}, &Trial::delta_bic);
    if (best == selection.trials.end() || !(best->delta_bic > thresholds::kPromising)) return;
    std::vector<std::string> names;
    for (const Trial& one : selection.trials)
        if (one.delta_bic > best->delta_bic - thresholds::kDraw)
            names.emplace_back(effect_of(study, one.effect).name);
    verdict.cautions.push_back(fmt::format(
        "{} fits what was measured (BIC better by {:.0f}), but gains nothing for sure on runs that were not "
        "fitted: if few runs show it, record more of these",
        fmt::join(names, " or "), best->delta_bic));
}

void add_held_out(const Study& study, const Selection& selection, std::uint64_t seed, Verdict& verdict) {
    HeldFigures figures = held_figures(study, selection, seed);
    verdict.heldout = figures.all;
    verdict.heldout.gain = !verdict.causes.empty();
    verdict.observables = std::move(figures.observables);
}

/// Each observable by the simulator as it is, then with the causes.
void add_predictive(const Study& study, const Judged& judged, std::uint64_t seed, Verdict& verdict) {
    const bool causes = !judged.chosen.final.effects.empty();
    auto stands = judged.diagnosis.predictive;
    if (stands.empty()) stands = predictive_checks(study, judged.chosen.final, causes, seed);
    const auto as_it_is =
        causes ? predictive_checks(study, judged.chosen.selection.none, false, seed) : stands;
    for (std::size_t o = 0; o < as_it_is.size(); ++o) {
        verdict.predictive.push_back(as_it_is[o]);
        if (causes) verdict.predictive.push_back(std::move(stands[o]));
    }
}

/// Where something is wrong that no name explains.
void add_extension(const Study& study, const Chosen& chosen, std::uint64_t seed, Verdict& verdict) {
    const bool forms = std::ranges::any_of(verdict.free_forms, [](const FreeForm& one) { return one.clear; });
    if (verdict.decision == Decision::NoEffect)
        verdict.extension.not_asked = "nothing is wrong";
    else if (verdict.decision == Decision::Named && verdict.leftovers.empty() && !forms)
        verdict.extension.not_asked = "nothing remains beside what is named";
    else
        verdict.extension = extension_of(study, chosen.selection.none, chosen.final, seed);
    verdict.extension.sentence = extension_sentence(verdict.extension);
}

}  // namespace

bool fit_failed(double delta_bic, std::size_t parameters, std::size_t rows) {
    return delta_bic <
           -thresholds::kClearBic - static_cast<double>(parameters) * std::log(static_cast<double>(rows));
}

Verdict verdict_of(const Study& study, Judged judged, std::uint64_t seed) {
    const Experiment& experiment = study.experiment();
    Verdict verdict;
    verdict.kind = experiment.kind;
    verdict.seed = seed;
    verdict.cautions = experiment.cautions;
    for (const std::string& caution : judged.cautions)
        verdict.cautions.push_back(caution);
    verdict.decision = judged.decision;
    verdict.grounds = judged.grounds;
    verdict.doubt = judged.doubt;
    verdict.confirmation = judged.confirmation;
    verdict.unexplained_share = judged.unexplained;
    if (judged.refused)
        verdict.nearest = causes_of(study, *judged.refused, precision_of(study, judged.refused->final),
                                    judged.refused_forms);
    add_causes(study, judged, verdict);
    add_mistaken(study, judged, verdict);
    add_without_place(study, verdict);
    verdict.series = std::move(judged.diagnosis.series);
    verdict.leftovers = std::move(judged.diagnosis.leftovers);
    verdict.free_forms = std::move(judged.diagnosis.free_forms);
    add_tried(study, judged.chosen.selection, verdict);
    add_few_runs_caution(study, judged.chosen.selection, verdict);
    add_held_out(study, judged.chosen.selection, seed, verdict);
    add_predictive(study, judged, seed, verdict);
    for (const Series& series : verdict.series)
        for (const std::string& caution : {placement_caution(experiment, series), circular_caution(series)})
            if (!caution.empty()) verdict.cautions.push_back(caution);
    verdict.grounds.rival = doubtful(verdict);
    if (verdict.decision == Decision::Named) verdict.decision = decision_of(verdict.grounds, "");
    verdict.suggestions = verdict.decision == Decision::NotIdentifiable
                              ? identifying(study, judged.chosen.selection.none, judged.not_identified)
                              : suggestions_for(study, judged.chosen.selection);
    add_extension(study, judged.chosen, seed, verdict);
    verdict.heldout.sentence = gain_sentence(verdict.heldout);
    verdict.summary = summary_of(verdict);
    return verdict;
}

}  // namespace puckloop::gap
