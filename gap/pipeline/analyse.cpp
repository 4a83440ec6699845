// The whole way from an experiment to a verdict: select effects, fit them together with what the measuring
// chain always adds, look at what is left, decide (gap/decide/decide.cpp).

#include "gap/pipeline/analyse.h"

#include "gap/decide/confirm.h"
#include "gap/decide/decide.h"
#include "gap/decide/range_end.h"
#include "gap/decide/roles.h"
#include "gap/decide/thresholds.h"
#include "gap/diagnostics/agenda.h"
#include "gap/diagnostics/heldout.h"
#include "gap/diagnostics/leftovers.h"
#include "gap/diagnostics/scatter.h"
#include "gap/diagnostics/series.h"
#include "gap/evidence/criterion.h"
#include "gap/fit/intervals.h"
#include "gap/fit/select.h"
#include "gap/fit_test/rival_forms.h"
#include "gap/next_experiment/suggest.h"
#include "gap/overlay/overlay_names.h"
#include "gap/residual_model/free_form.h"
#include "gap/stats/tails.h"
#include "gap/validate/placements.h"
#include "gap/verdict/sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace puckloop::gap {

namespace {

/// The analysis of one experiment from one view.
class Analysis {
  public:
    Analysis(const Experiment& experiment, const Options& options, MotionView view, bool confirms = true)
        : experiment_(experiment),
          options_(options),
          confirms_(confirms),
          study_(experiment, options.seed, options.threads, view),
          search_(study_, options_.progress) {}

    /// Log score of held-out rows after the first step.
    double first() { return search_.first(); }

    /// After first().
    Verdict run() {
        verdict_.kind = experiment_.kind;
        verdict_.seed = options_.seed;
        verdict_.cautions = experiment_.cautions;
        selection_ = search_.rest();
        tell("what is left", 0.88);
        final_ = with_nuisances();
        look_at_rest();
        const std::string doubt = doubted();
        verdict_.decision = decision_of(verdict_.grounds, doubt);
        if (!doubt.empty()) {
            take_back(doubt);
            // What the causes had covered is open now.
            if (verdict_.decision == Decision::NoEffect) verdict_.decision = decision_of(grounds(), "");
        }
        tell("intervals", 0.96);
        fill_causes();
        fill_tried();
        fill_held();
        for (const Series& series : verdict_.series)
            for (const std::string& caution :
                 {placement_caution(experiment_, series), circular_caution(series)})
                if (!caution.empty()) verdict_.cautions.push_back(caution);
        verdict_.grounds.rival = doubtful(verdict_);
        if (verdict_.decision == Decision::Named) verdict_.decision = decision_of(verdict_.grounds, "");
        verdict_.suggestions = suggestions_for(study_, selection_);
        verdict_.heldout.sentence = gain_sentence(verdict_.heldout);
        verdict_.summary = summary_of(verdict_);
        return std::move(verdict_);
    }

    /// What was found, for whoever asks whether there is anything at all. After run().
    double found() const { return found_; }

  private:
    void tell(const std::string& what, double share) const {
        if (options_.progress) options_.progress(what, share);
    }

    const Effect& effect(std::size_t candidate) const { return *study_.candidates()[candidate].effect; }

    FittedParameter parameter_of(const Fit& fit, const Precision& precision, std::size_t j) const {
        const Freed& freed = fit.freed[j];
        const ModelParameter& parameter = study_.model().parameters()[static_cast<std::size_t>(freed.index)];
        const double value = fit.fitted.state.values[static_cast<std::size_t>(freed.index)];
        const Interval interval = interval_of(study_, fit, precision, j);
        return {parameter.name,
                parameter.unit,
                value,
                interval.low,
                interval.high,
                parameter.neutral,
                parameter.simulator || overlay_takes(parameter.name)};
    }

    Cause cause_of(const Fit& fit, const Precision& precision, std::size_t candidate) const {
        const Effect& own = effect(candidate);
        Cause cause;
        cause.name = own.name;
        cause.number = own.number;
        cause.title = own.title;
        for (const Freed& freed : study_.candidates()[candidate].freed)
            for (std::size_t j = 0; j < fit.freed.size(); ++j)
                if (fit.freed[j].index == freed.index)
                    cause.parameters.push_back(parameter_of(fit, precision, j));
        const auto form = std::find_if(forms_.begin(), forms_.end(),
                                       [&](const auto& one) { return one.first == candidate; });
        if (form != forms_.end()) cause.form = form_words(form->second);
        cause.sentence = cause_sentence(cause);
        return cause;
    }

    /// The chosen set with tracker offset, tracker delay and sensor age fitted along, where the data tells
    /// them from it.
    Fit with_nuisances() const {
        Fit fit = selection_.chosen;
        if (fit.effects.empty()) return fit;
        for (std::size_t i = 0; i < study_.candidates().size(); ++i) {
            const Candidate& candidate = study_.candidates()[i];
            if (!candidate.effect->fitted_along || !candidate.remark.empty()) continue;
            if (std::find(fit.effects.begin(), fit.effects.end(), i) != fit.effects.end()) continue;
            auto set = fit.effects;
            set.push_back(i);
            const Fit wider = study_.fit_set(set, fit.fitted.state);
            const Precision precision = precision_of(study_, wider);
            bool fixed = false;
            for (std::size_t j = 0; j < wider.freed.size(); ++j)
                for (std::size_t k = 0; k < j; ++k)
                    fixed = fixed || std::abs(precision.correlation(static_cast<Eigen::Index>(j),
                                                                    static_cast<Eigen::Index>(k))) >
                                         thresholds::kOneNumber;
            if (!fixed) fit = wider;
        }
        return fit;
    }

    std::vector<Cause> chosen_causes(const Precision& precision) const {
        std::vector<Cause> causes;
        for (const Trial& step : selection_.steps) {
            Cause cause = cause_of(final_, precision, step.effect);
            cause.evidence = step.delta_bic;
            cause.score_gain = step.held.sum;
            cause.score_low = step.held.sum - 1.645 * step.held.sd;
            cause.score_high = step.held.sum + 1.645 * step.held.sd;
            causes.push_back(std::move(cause));
        }
        return causes;
    }

    void fill_causes() {
        const Precision precision = precision_of(study_, final_);
        verdict_.causes = chosen_causes(precision);
        caution_of_edges();
        for (std::size_t k = selection_.chosen.effects.size(); k < final_.effects.size(); ++k)
            for (const auto& parameter : cause_of(final_, precision, final_.effects[k]).parameters)
                verdict_.nuisance.push_back(parameter);
        for (const Draw& draw : selection_.draws) {
            Rival rival;
            rival.cause = cause_of(draw.fit, precision_of(study_, draw.fit), draw.rival);
            rival.instead_of = effect(draw.chosen).name;
            rival.delta_bic = draw.delta_bic;
            rival.separated_by = effect(draw.chosen).separated_by;
            rival.cause.evidence = selection_.none.bic - draw.fit.bic;
            rival.cause.score_gain = -draw.held.sum;
            verdict_.rivals.push_back(std::move(rival));
        }
        pass_over_empty();
    }

    /// A later cause whose intervals hold what the simulator has says nothing for sure: what could stand in
    /// its place does not make a clear first cause doubtful.
    void pass_over_empty() {
        for (std::size_t k = 1; k < verdict_.causes.size(); ++k) {
            const Cause& cause = verdict_.causes[k];
            if (!std::all_of(cause.parameters.begin(), cause.parameters.end(),
                             [](const auto& p) { return p.low <= p.neutral && p.neutral <= p.high; }))
                continue;
            verdict_.cautions.push_back(
                fmt::format("{}: its interval holds the simulator's value, so it may be none", cause.name));
            std::erase_if(verdict_.rivals,
                          [&](const Rival& rival) { return rival.instead_of == cause.name; });
        }
    }

    /// Is a freed parameter at an end of its plausible range? It was stopped there, not found there.
    bool at_edge(const Freed& freed, double& edge) const {
        const auto index = static_cast<std::size_t>(freed.index);
        edge = range_end(final_.fitted.state.values[index], freed.low, freed.high,
                         study_.model().parameters()[index].neutral);
        return !std::isnan(edge);
    }

    bool stopped_at_edge() const {
        double edge = 0.0;
        return std::any_of(final_.freed.begin(), final_.freed.end(),
                           [&](const Freed& freed) { return at_edge(freed, edge) && carries(freed); });
    }

    /// Does a parameter make much of what is gained? Of an effect with several, one may stop at its end
    /// beside the one that explains. With it back at neutral and nothing else fitted again, this errs towards
    /// yes.
    bool carries(const Freed& freed) const {
        const auto at = [&](const State& state) {
            Prediction prediction;
            double sum = 0.0;
            for (const RowCosts& costs : costs_at(study_.model(), state, prediction))
                for (const double cost : costs.cost)
                    sum += cost;
            return sum;
        };
        const auto index = static_cast<std::size_t>(freed.index);
        State without = final_.fitted.state;
        without.values[index] = study_.model().parameters()[index].neutral;
        const double best = at(final_.fitted.state), none = at(selection_.none.fitted.state);
        return at(without) - best > thresholds::kShareLeft * (none - best);
    }

    bool any_form_is_clear() const {
        return std::any_of(verdict_.free_forms.begin(), verdict_.free_forms.end(),
                           [](const FreeForm& form) { return form.clear; });
    }

    void caution_of_edges() {
        double edge = 0.0;
        for (const Freed& freed : final_.freed) {
            if (!at_edge(freed, edge)) continue;
            const ModelParameter& parameter =
                study_.model().parameters()[static_cast<std::size_t>(freed.index)];
            verdict_.cautions.push_back(
                fmt::format("{} stands at the end of its plausible range ({}): it was "
                            "stopped there, so its value and its cause are doubtful",
                            parameter.name, quantity(edge, parameter.unit)));
        }
    }

    /// With fewer than three runs stretches of the same run are held out: a drift of that run predicts
    /// itself. Then the error has to fall for sure, not only the score to rise.
    bool few_runs_disagree() const {
        return experiment_.runs.size() < thresholds::kRunsThatJudge &&
               held_figures(study_, selection_, options_.seed).all.high >= 1.0;
    }

    /// What speaks against the causes, asked from the cheap to the dear until something does.
    std::string doubted() {
        Grounds& g = verdict_.grounds = grounds();
        const auto goes_on = [&] { return g.causes > 0 && doubt_of(g).empty(); };
        if (goes_on()) ask_roles(g);
        if (goes_on() && confirms_) confirm(g);
        const std::string doubt = doubt_of(g);
        if (!options_.ask_all || doubt.empty() || !confirms_) return doubt;
        if (g.out_of_role.empty())
            g.out_of_role = out_of_role(study_, selection_.chosen, selection_.held_chosen, verdict_.leftovers,
                                        options_.seed)
                                .why;
        if (g.not_confirmed.empty()) confirm(g);
        return doubt;
    }

    void confirm(Grounds& g) const {
        tell("asking the other half of the runs", 0.92);
        g.not_confirmed = not_confirmed(study_, selection_, share_allowed(),
                                        [&](const Experiment& half) { return asked(half); });
    }

    /// Causes that are out of their role go by themselves where the first of them stands without them.
    void ask_roles(Grounds& g) {
        const OutOfRole out =
            out_of_role(study_, selection_.chosen, selection_.held_chosen, verdict_.leftovers, options_.seed);
        if (out.effects.empty()) return;
        if (!go_without(out.effects, out.why)) {
            g.out_of_role = out.why;
            g.law_alone = out.law_alone;
            return;
        }
        for (const std::size_t one : out.effects)
            verdict_.cautions.push_back(
                fmt::format("{} would have to be part of it, but {}: not named", effect(one).name, out.why));
        g = grounds();
    }

    /// Half of the experiment, corrected by what the other half told, as an experiment of its own.
    Asked asked(const Experiment& half) const {
        Options quiet = options_;
        quiet.progress = nullptr;
        Analysis other(half, quiet, study_.view(), false);
        (void)other.first();
        const Verdict verdict = other.run();
        Asked result;
        result.nothing = verdict.decision == Decision::NoEffect;
        result.found = other.found();
        const auto& causes = verdict.causes.empty() ? verdict.nearest : verdict.causes;
        result.what = causes.empty() ? "structure" : fmt::format("\"{}\"", causes.front().title);
        return result;
    }

    Grounds grounds() const {
        Grounds g;
        g.causes = selection_.steps.size();
        for (const Candidate& candidate : study_.candidates())
            g.candidates += candidate.remark.empty() ? 1 : 0;
        g.gain = gain_of(gains_by_block(study_.blocks(), selection_.held_none, selection_.held_chosen));
        g.assumed = fmt::format("{}", fmt::join(experiment_.assumed, ", "));
        g.stopped_at_end = stopped_at_edge();
        const auto& chosen = selection_.chosen.effects;
        g.in_rounding = !chosen.empty() && std::all_of(chosen.begin(), chosen.end(), [&](std::size_t one) {
            return within_rounding(study_, selection_.chosen, one);
        });
        g.error_falls = g.causes == 0 || !few_runs_disagree();
        g.left_by_shape = gained_by_shape(verdict_.free_forms);
        for (const auto& [effect, form] : forms_)
            g.left_by_form = std::max(g.left_by_form, form.left);
        g.left_by_run = runs_.by_run;
        g.left_by_jump = runs_.by_jump;
        g.left_by_structure = by_structure_;
        g.sums = adds_up();
        for (const Observable& observable : study_.model().observables())
            for (const FreeForm& form : verdict_.free_forms)
                if (form.observable == observable.name && observable.noise != NoiseKind::Level &&
                    form.clear && !form.wild)
                    g.left_of_readings += form.gain;
        g.structure = any_form_is_clear() ||
                      std::any_of(verdict_.leftovers.begin(), verdict_.leftovers.end(),
                                  [](const Leftover& one) { return one.p_value < thresholds::kSure; });
        return g;
    }

    /// Effects that are doubted by themselves go, and the other causes stay. False: one of them is the first
    /// of the causes, which the others were built on.
    bool go_without(const std::vector<std::size_t>& doubted, const std::string& doubt) {
        const auto is_doubted = [&](std::size_t one) {
            return std::find(doubted.begin(), doubted.end(), one) != doubted.end();
        };
        if (is_doubted(selection_.steps.front().effect)) return false;
        Selection whole = selection_;
        selection_.chosen = without_effects(study_, selection_.chosen, doubted);
        selection_.held_chosen = study_.hold_out(selection_.chosen);
        for (const std::size_t one : doubted)
            selection_.trials[one].remark = "comes nearest to what is left, but " + doubt;
        std::erase_if(selection_.steps, [&](const Trial& step) { return is_doubted(step.effect); });
        if (!weigh_again()) {
            selection_ = std::move(whole);
            return false;
        }
        std::erase_if(selection_.draws, [&](const Draw& draw) {
            return std::find(selection_.chosen.effects.begin(), selection_.chosen.effects.end(),
                             draw.chosen) == selection_.chosen.effects.end();
        });
        final_ = with_nuisances();
        look_at_rest();
        return true;
    }

    /// What each cause says now that others are gone; those that say too little go, the weakest first. False:
    /// the first of them would have to go.
    bool weigh_again() {
        while (true) {
            std::size_t weakest = 0;
            for (Trial& step : selection_.steps) {
                const Fit fewer = without_effects(study_, selection_.chosen, {step.effect});
                step.delta_bic = fewer.bic - selection_.chosen.bic;
                step.held =
                    gain_of(gains_by_block(study_.blocks(), study_.hold_out(fewer), selection_.held_chosen));
                if (step.held.sum < selection_.steps[weakest].held.sum)
                    weakest = static_cast<std::size_t>(&step - selection_.steps.data());
            }
            const Trial& least = selection_.steps[weakest];
            if (gains_enough(least.held, study_.candidates().size(), 1)) return true;
            if (weakest == 0) return false;
            selection_.trials[least.effect].remark = "says too little without what was doubted beside it";
            selection_.chosen = without_effects(study_, selection_.chosen, {least.effect});
            selection_.held_chosen = study_.hold_out(selection_.chosen);
            selection_.steps.erase(selection_.steps.begin() + static_cast<std::ptrdiff_t>(weakest));
        }
    }

    void fill_tried() {
        for (const Trial& trial : selection_.trials) {
            Tried tried{effect(trial.effect).name,
                        effect(trial.effect).number,
                        trial.delta_bic,
                        trial.held.sum,
                        1.0,
                        trial.remark};
            if (trial.validated && trial.held.sd > 0)
                tried.p_value = stats::normal_tail(trial.held.sum / trial.held.sd);
            for (std::size_t k = 0; k < selection_.steps.size(); ++k)
                if (selection_.steps[k].effect == trial.effect)
                    tried.remark = fmt::format("chosen, step {}", k + 1);
            verdict_.tried.push_back(std::move(tried));
        }
    }

    void fill_held() {
        HeldFigures figures = held_figures(study_, selection_, options_.seed);
        verdict_.heldout = figures.all;
        verdict_.heldout.gain = !verdict_.causes.empty();
        verdict_.observables = std::move(figures.observables);
    }

    /// Offsets of placements say more than that rows carry over.
    void tell_placements() {
        for (const Series& series : verdict_.series) {
            const std::string shape = placement_shape(experiment_, series);
            if (shape.empty()) continue;
            const auto serial =
                std::find_if(verdict_.leftovers.begin(), verdict_.leftovers.end(), [&](const Leftover& one) {
                    return one.observable == series.observable && one.covariate == "previous sample";
                });
            if (serial == verdict_.leftovers.end()) continue;
            serial->covariate = kPlacementCovariate;
            serial->shape = shape;
        }
    }

    /// Structures and free forms that are left with what is chosen, and their share of all that is gained.
    void look_at_rest() {
        verdict_.series = series_of(study_.model(), selection_.none.fitted.state, final_.fitted.state);
        std::vector<double> quanta;
        for (const Observable& observable : study_.model().observables())
            quanta.push_back(observable.instrument.quantum);
        verdict_.leftovers =
            leftovers_of(experiment_, verdict_.series, quanta, options_.seed, thresholds::kReported);
        tell_placements();
        verdict_.free_forms = free_forms_of(experiment_, study_.model(), final_.fitted.state, options_.seed);
        runs_ = left_by_runs(study_, final_.fitted.state);
        look_at_forms();
        by_structure_ = most_by_structure(verdict_.leftovers);
        verdict_.leftovers.insert(verdict_.leftovers.end(), runs_.structures.begin(), runs_.structures.end());
        std::stable_sort(verdict_.leftovers.begin(), verdict_.leftovers.end(),
                         [](const auto& a, const auto& b) { return a.p_value < b.p_value; });
        const Grounds g = grounds();
        verdict_.unexplained_share = g.unexplained();
        found_ = std::max(g.causes > 0 ? g.gain.sum : 0.0, 0.0) + g.left();
    }

    /// Are the forms of the chosen effects told from their neighbours'?
    void look_at_forms() {
        forms_.clear();
        for (const Trial& step : selection_.steps)
            forms_.emplace_back(step.effect,
                                form_verdict(rival_forms(study_, selection_.chosen, step.effect)));
    }

    bool adds_up() const {
        const auto& all = study_.model().observables();
        return std::any_of(all.begin(), all.end(),
                           [](const Observable& observable) { return observable.noise == NoiseKind::Level; });
    }

    /// Of sums more may be left: their free forms act on single steps, and cannot say what adds up.
    double share_allowed() const { return adds_up() ? thresholds::kShareLeftOfSums : thresholds::kShareLeft; }

    /// An effect fitted to what it does not describe soaks up some of it and leaves much. Then nothing is
    /// named: what came nearest is told as such, and all that is left is looked at again.
    void take_back(const std::string& doubt) {
        verdict_.doubt = doubt;
        verdict_.nearest = chosen_causes(precision_of(study_, final_));
        for (const Trial& step : selection_.steps)
            selection_.trials[step.effect].remark = "came nearest, but " + doubt;
        selection_.steps.clear();
        selection_.draws.clear();
        selection_.chosen = final_ = selection_.none;
        selection_.held_chosen = selection_.held_none;
        look_at_rest();
    }

    const Experiment& experiment_;
    const Options& options_;
    bool confirms_;
    Study study_;
    Search search_;
    Selection selection_;
    Fit final_;
    LeftByRuns runs_;
    double by_structure_ = 0.0;                               ///< nats; of all structures but those of runs
    std::vector<std::pair<std::size_t, FormVerdict>> forms_;  ///< of the chosen effects
    double found_ = 0.0;                                      ///< nats
    Verdict verdict_;
};

}  // namespace

Verdict analyse(const Experiment& experiment, const Options& options) {
    // Way along and across the heading, and in the room, are the same numbers turned: their log scores
    // compare.
    std::vector<std::unique_ptr<Analysis>> views;
    views.push_back(std::make_unique<Analysis>(experiment, options, MotionView::Robot));
    if (experiment.kind == Kind::Motion)
        views.push_back(std::make_unique<Analysis>(experiment, options, MotionView::Room));
    std::vector<double> score;
    for (const auto& view : views)
        score.push_back(view->first());
    const auto best = static_cast<std::size_t>(std::max_element(score.begin(), score.end()) - score.begin());
    Verdict verdict = views[best]->run();
    if (views.size() == 1) return verdict;
    if (verdict.decision == Decision::NoEffect) {
        Verdict other = views[1 - best]->run();
        if (other.decision == Decision::NoEffect) return verdict;
        other.cautions.push_back(fmt::format("seen {} only", best == 0 ? "from the room (x_m, y_m)"
                                                                       : "along the robot's own axes"));
        return other;
    }
    std::vector<std::string> found;
    for (const auto* causes : {&verdict.causes, &verdict.nearest})
        for (const Cause& cause : *causes)
            found.push_back(cause.name);
    auto caution = agenda_caution(experiment, found, options.seed, options.threads);
    if (!caution.empty()) verdict.cautions.push_back(std::move(caution));
    return verdict;
}

std::vector<Series> simulate(const Experiment& experiment, const std::map<std::string, double>& changed) {
    const auto model = make_model(experiment);
    const State before = neutral_state(*model);
    State after = before;
    for (const auto& [name, value] : changed)
        for (const int index : model->matching(name))
            after.values[static_cast<std::size_t>(index)] = value;
    return series_of(*model, before, after);
}

}  // namespace puckloop::gap
