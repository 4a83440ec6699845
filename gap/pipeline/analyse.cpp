// The whole way from an experiment to a verdict: select effects, fit them together with what the measuring
// chain always adds, judge what is gained on held-out runs and what is left.

#include "gap/pipeline/analyse.h"

#include "gap/decide/range_end.h"
#include "gap/diagnostics/agenda.h"
#include "gap/diagnostics/heldout.h"
#include "gap/diagnostics/leftovers.h"
#include "gap/diagnostics/pushes.h"
#include "gap/diagnostics/repeats.h"
#include "gap/diagnostics/scatter.h"
#include "gap/diagnostics/series.h"
#include "gap/fit/intervals.h"
#include "gap/fit/select.h"
#include "gap/next_experiment/suggest.h"
#include "gap/residual_model/free_form.h"
#include "gap/stats/tails.h"
#include "gap/validate/placements.h"
#include "gap/verdict/sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kLeftLevel = 0.01;  // corrected p of a structure worth telling
constexpr double kSureLevel = 1e-3;  // of a structure that by itself makes a verdict
constexpr double kUnexplainedShareOfSums = 0.5;
constexpr double kUnexplainedShare = 0.2;  // of all that is gained: what leaves this much is not the cause
constexpr std::size_t kRunsThatJudge = 3;
constexpr double kFixedByOthers =
    0.97;  // correlation beyond which a parameter of the measuring chain is not fitted along

constexpr const char* kPlacement = "placement";
constexpr const char* kNoScatter = "explains scatter that repeats, has a shape or comes in spells";
constexpr std::string_view kPushes = "collision_push";

const char* const kNuisances[] = {"marker_offset", "tracker_delay", "stale_readings"};

class Analysis {
  public:
    Analysis(const Experiment& experiment, const Options& options, MotionView view)
        : experiment_(experiment),
          options_(options),
          study_(experiment, options.seed, options.threads, view) {}

    Verdict run() {
        verdict_.kind = experiment_.kind;
        verdict_.seed = options_.seed;
        verdict_.cautions = experiment_.cautions;
        selection_ = select(study_, options_.progress);
        tell("what is left", 0.88);
        final_ = with_nuisances();
        look_at_rest();
        const std::string doubt = selection_.steps.empty() ? "" : doubt_of_causes();
        if (!doubt.empty()) take_back(doubt);
        tell("intervals", 0.96);
        fill_causes();
        fill_tried();
        fill_held();
        for (const Series& series : verdict_.series)
            for (const std::string& caution :
                 {placement_caution(experiment_, series), circular_caution(series)})
                if (!caution.empty()) verdict_.cautions.push_back(caution);
        decide();
        verdict_.suggestions = suggestions_for(study_, selection_);
        verdict_.heldout.sentence = gain_sentence(verdict_.heldout);
        verdict_.summary = summary_of(verdict_);
        return std::move(verdict_);
    }

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
                parameter.simulator || parameter.name.starts_with("wheel_") ||
                    parameter.name == "inverse_friction"};
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
        cause.sentence = cause_sentence(cause);
        return cause;
    }

    /// The chosen set with tracker offset, tracker delay and sensor age fitted along, where the data tells
    /// them from it.
    Fit with_nuisances() const {
        Fit fit = selection_.chosen;
        if (fit.effects.empty()) return fit;
        for (const char* name : kNuisances)
            for (std::size_t i = 0; i < study_.candidates().size(); ++i) {
                const Candidate& candidate = study_.candidates()[i];
                if (candidate.effect->name != std::string_view(name) || !candidate.remark.empty()) continue;
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
                                             kFixedByOthers;
                if (!fixed && wider.bic < fit.bic + 40) fit = wider;
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
        return at(without) - best > kUnexplainedShare * (none - best);
    }

    bool something_left() const { return !verdict_.leftovers.empty() || any_form_is_clear(); }

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
    bool few_runs_disagree() {
        return experiment_.runs.size() < kRunsThatJudge &&
               held_figures(study_, selection_, options_.seed).all.high >= 1.0;
    }

    /// A mean that the model lacks looks like larger errors. What repeats at each placement is no scatter,
    /// nor is what has a shape: the free forms are asked again without the effects that only scatter. And
    /// what comes in spells is no lapse that has a chance of its own.
    bool scatter_hides_a_mean() const {
        const auto scatter = scatter_effects(study_, selection_.chosen);
        if (scatter.empty()) return false;
        const auto touched = scattered_by(study_, selection_.chosen, scatter);
        if (touched.empty()) return false;
        for (const Leftover& left : verdict_.leftovers)
            if (left.covariate == kPlacement && left.p_value < kSureLevel &&
                std::find(touched.begin(), touched.end(), left.observable) != touched.end())
                return true;
        if (stats::normal_tail(repeats_at_once(study_, selection_.chosen, scatter)) < kSureLevel) return true;
        const Fit calm = without_effects(study_, selection_.chosen, scatter);
        const auto forms =
            free_forms_of(experiment_, study_.model(), calm.fitted.state, options_.seed, touched);
        const bool spells =
            std::any_of(forms.begin(), forms.end(), [](const FreeForm& form) { return form.spells; });
        if (spells && lapses(study_, selection_.chosen)) return true;
        const double shaped = gained(forms);
        const double won = std::max(
            gain_of(gains_by_block(study_.blocks(), study_.hold_out(calm), selection_.held_chosen)).sum, 0.0);
        return shaped > 0 && shaped > kUnexplainedShare * (shaped + won);
    }

    /// Why what was chosen is not the cause, in words that follow "but"; empty: nothing speaks against it.
    std::string doubt_of_causes() {
        if (pushes_keep_to_something()) return "keeps to something that no push knows of";
        if (!experiment_.assumed.empty())
            return fmt::format("{} was assumed, not measured, and an error of it may look the same",
                               fmt::join(experiment_.assumed, ", "));
        if (auto doubt = doubt_of_what_is_left(); !doubt.empty()) return doubt;
        if (!scatter_hides_a_mean()) return "";
        const auto scatter = scatter_effects(study_, selection_.chosen);
        if (!go_without(scatter, kNoScatter)) return kNoScatter;
        for (const std::size_t one : scatter)
            verdict_.cautions.push_back(fmt::format("{} would have to be part of it, but {}: not named",
                                                    effect(one).name, kNoScatter));
        return doubt_of_what_is_left();
    }

    std::string doubt_of_what_is_left() {
        if (verdict_.unexplained_share > share_allowed()) return "leaves too much to be the cause";
        if (stopped_at_edge() && something_left())
            return "stopped at the end of its plausible range and leaves something";
        if (few_runs_disagree()) return "lowers the error of so few runs by chance only, as far as they tell";
        return "";
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
                if (step.delta_bic < selection_.steps[weakest].delta_bic)
                    weakest = static_cast<std::size_t>(&step - selection_.steps.data());
            }
            const Trial& least = selection_.steps[weakest];
            if (least.delta_bic >= kEnoughBic) return true;
            if (weakest == 0) return false;
            selection_.trials[least.effect].remark = "says too little without what was doubted beside it";
            selection_.chosen = without_effects(study_, selection_.chosen, {least.effect});
            selection_.held_chosen = study_.hold_out(selection_.chosen);
            selection_.steps.erase(selection_.steps.begin() + static_cast<std::ptrdiff_t>(weakest));
        }
    }

    /// Pushes that keep to a place or to a command are none. First of the causes, they were all there was;
    /// beside another cause they go and it stays.
    bool pushes_keep_to_something() {
        const auto step = std::find_if(selection_.steps.begin(), selection_.steps.end(),
                                       [&](const Trial& one) { return effect(one.effect).name == kPushes; });
        if (step == selection_.steps.end()) return false;
        const auto pattern = push_pattern(experiment_, study_.model(), final_.fitted.state);
        if (!pattern) return false;
        verdict_.cautions.push_back(
            fmt::format("jumps look like pushes, but {:.0f} of {:.0f} come at {} (by chance {:.1f}): no push "
                        "knows of that",
                        pattern->pushes, pattern->all, pattern->where, pattern->expected));
        return !go_without({step->effect}, "keeps to something");
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
                tried.p_value = std::erfc(trial.held.sum / trial.held.sd / std::sqrt(2.0)) / 2;
            for (std::size_t k = 0; k < selection_.steps.size(); ++k)
                if (selection_.steps[k].effect == trial.effect)
                    tried.remark = fmt::format("chosen, step {}", k + 1);
            verdict_.tried.push_back(std::move(tried));
        }
    }

    void fill_held() {
        HeldFigures figures = held_figures(study_, selection_, options_.seed);
        verdict_.heldout = figures.all;
        verdict_.heldout.gain = !verdict_.causes.empty() && verdict_.heldout.score_low > 0;
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
            serial->covariate = kPlacement;
            serial->shape = shape;
        }
    }

    /// Structures and free forms that are left with what is chosen, and their share of all that is gained.
    void look_at_rest() {
        verdict_.series = series_of(study_.model(), selection_.none.fitted.state, final_.fitted.state);
        verdict_.leftovers = leftovers_of(experiment_, verdict_.series, options_.seed, kLeftLevel);
        tell_placements();
        verdict_.free_forms = free_forms_of(experiment_, study_.model(), final_.fitted.state, options_.seed);
        const double left = gained(verdict_.free_forms);
        const double won = std::max(
            gain_of(gains_by_block(study_.blocks(), selection_.held_none, selection_.held_chosen)).sum, 0.0);
        verdict_.unexplained_share = left > 0 ? left / (left + won) : 0.0;
    }

    static double gained(const std::vector<FreeForm>& forms) {
        double sum = 0.0;
        for (const FreeForm& form : forms)
            if (form.clear && !form.wild) sum += form.gain;
        return sum;
    }

    /// Of sums more may be left: their free forms act on single steps, and cannot say what adds up.
    double share_allowed() const {
        const auto& all = study_.model().observables();
        const bool sums = std::any_of(all.begin(), all.end(), [](const Observable& observable) {
            return observable.noise == NoiseKind::Level;
        });
        return sums ? kUnexplainedShareOfSums : kUnexplainedShare;
    }

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

    void decide() {
        const bool sure = std::any_of(verdict_.leftovers.begin(), verdict_.leftovers.end(),
                                      [](const Leftover& one) { return one.p_value < kSureLevel; }) ||
                          any_form_is_clear();
        if (!verdict_.causes.empty())
            verdict_.decision = doubtful(verdict_) ? Decision::CannotTell : Decision::Named;
        else
            verdict_.decision =
                sure || !verdict_.nearest.empty() ? Decision::Unexplained : Decision::NoEffect;
    }

    const Experiment& experiment_;
    const Options& options_;
    Study study_;
    Selection selection_;
    Fit final_;
    Verdict verdict_;
};

}  // namespace

Verdict analyse(const Experiment& experiment, const Options& options) {
    Verdict verdict = Analysis(experiment, options, MotionView::Robot).run();
    if (experiment.kind != Kind::Motion) return verdict;
    if (verdict.decision != Decision::NoEffect) {
        std::vector<std::string> found;
        for (const auto* causes : {&verdict.causes, &verdict.nearest})
            for (const Cause& cause : *causes)
                found.push_back(cause.name);
        auto caution = agenda_caution(experiment, found, options.seed, options.threads);
        if (!caution.empty()) verdict.cautions.push_back(std::move(caution));
        return verdict;
    }
    Verdict from_room = Analysis(experiment, options, MotionView::Room).run();
    if (from_room.decision == Decision::NoEffect) return verdict;
    from_room.cautions.emplace_back(
        "seen from the room only (x_m, y_m): along the robot's own axes nothing is more than the noise");
    return from_room;
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
