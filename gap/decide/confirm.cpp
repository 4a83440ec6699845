#include "gap/decide/confirm.h"

#include "gap/evidence/criterion.h"
#include "gap/evidence/thresholds.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr Effort kConfirmingEffort{.iterations = 12};
constexpr double kSamePrediction = 1e-6;  // of an observable's noise

/// Runs of the second half: every other fold, so that repeats of one condition stand in both. The two runs in
/// which a cause gains most are parted, so that of what shows in few runs each half has some.
std::vector<char> second_half(const Study& study, const Selection& selection) {
    const std::size_t runs = study.experiment().runs.size();
    std::vector<char> second(runs, 0);
    std::vector<double> gains(runs, 0.0);
    const auto& observables = study.model().observables();
    for (std::size_t o = 0; o < observables.size(); ++o)
        for (std::size_t i = 0; i < observables[o].run.size(); ++i) {
            const std::uint32_t run = observables[o].run[i];
            second[run] = static_cast<char>(study.fold_of()[o][i] % 2);
            gains[run] += selection.held_chosen.score[o][i] - selection.held_none.score[o][i];
        }
    const auto best = [&] {
        return static_cast<std::size_t>(std::max_element(gains.begin(), gains.end()) - gains.begin());
    };
    const std::size_t most = best();
    gains[most] = -INFINITY;
    const std::size_t next = best();
    second[next] = second[most] != 0 ? 0 : 1;
    return second;
}

Experiment half_of(const Experiment& whole, const std::vector<char>& second) {
    Experiment half = whole;
    half.runs.clear();
    half.cautions.clear();
    for (std::size_t r = 0; r < whole.runs.size(); ++r)
        if (second[r] != 0) half.runs.push_back(whole.runs[r]);
    return half;
}

double cost_in(const Study& study, const State& state, const std::vector<char>& second) {
    const auto costs = costs_at(study.model(), state, study.model().predicted(state.values));
    double sum = 0.0;
    for (std::size_t o = 0; o < costs.size(); ++o)
        for (std::size_t i = 0; i < costs[o].cost.size(); ++i)
            if (second[study.model().observables()[o].run[i]] != 0) sum += costs[o].cost[i];
    return sum;
}

/// The half's numbers are those of the whole, which it may count otherwise (its sessions, its objects).
bool takes(Experiment& half, const Study& study, const Fit& fit) {
    const auto model = make_model(half);
    for (const Freed& freed : fit.freed) {
        const auto index = freed.index;
        const ModelParameter& parameter = study.model().parameters()[index];
        if (!model->find(parameter.name)) return false;
        half.nominal[parameter.name] = fit.fitted.state.values[index];
    }
    return true;
}

bool same_means(const Study& study, const Fit& fit, const Experiment& half, MotionView view,
                const std::vector<char>& second) {
    const auto model = make_model(half, view);
    const Prediction of_half = model->predicted(model->neutral()),
                     of_whole = study.model().predicted(fit.fitted.state.values);
    for (std::size_t o = 0; o < of_whole.size(); ++o) {
        const Observable& observable = study.model().observables()[o];
        if (observable.noise != NoiseKind::Carry) continue;
        const double near = kSamePrediction + 1e-3 * std::exp(fit.fitted.state.noise[o].log_sd);
        std::size_t next = 0;
        for (std::size_t i = 0; i < observable.run.size(); ++i) {
            if (second[observable.run[i]] == 0) continue;
            if (next >= of_half[o].mean.size()) return false;
            if (std::abs(of_half[o].mean[next++] - of_whole[o].mean[i]) > near) return false;
        }
    }
    return true;
}

/// Weights of the rows: those of the first half only.
Weights of_first(const Study& study, const std::vector<char>& second) {
    Weights first;
    for (const Observable& observable : study.model().observables()) {
        first.emplace_back();
        for (const std::uint32_t run : observable.run)
            first.back().push_back(second[run] != 0 ? 0.0 : 1.0);
    }
    return first;
}

}  // namespace

std::string not_confirmed(const Study& study, const Selection& selection, double share_left,
                          const std::function<Asked(const Experiment&)>& ask) {
    const Experiment& whole = study.experiment();
    if (whole.runs.size() < thresholds::kRunsToConfirm || study.folds() < 2) return "";
    const auto second = second_half(study, selection);
    const Weights first = of_first(study, second);
    Fit half_fit = selection.chosen;
    half_fit.fitted = fit(study.model(), half_fit.freed, half_fit.fitted.state, first, kConfirmingEffort);
    const Fitted none = fit(study.model(), {}, selection.none.fitted.state, first, kConfirmingEffort);
    const double won = cost_in(study, none.state, second) - cost_in(study, half_fit.fitted.state, second);
    if (!(won > 0)) return "does not gain on the half of the runs that was not fitted";
    Experiment half = half_of(whole, second);
    if (!takes(half, study, half_fit) || !same_means(study, half_fit, half, study.view(), second)) return "";
    const Asked asked = ask(half);
    if (asked.nothing || asked.found <= share_left * (asked.found + won)) return "";
    return fmt::format("fitted on half of the runs, it leaves {} in the other half", asked.what);
}

Confirmation confirmation_of(const Study& study, const Selection& selection, const ChooseOnHalf& choose) {
    Confirmation result;
    const Experiment& whole = study.experiment();
    if (selection.steps.empty()) return result;
    if (whole.runs.size() < thresholds::kRunsToConfirm || study.folds() < 2) {
        result.sentence =
            fmt::format("Not confirmed: {} run{} make no two halves, one to choose and fit on and "
                        "one to score; the name rests on runs that chose it.",
                        whole.runs.size(), whole.runs.size() == 1 ? "" : "s");
        return result;
    }
    auto second = second_half(study, selection);
    std::vector<char> chooses(second.size());
    std::ranges::transform(second, chooses.begin(), [](char one) { return static_cast<char>(one == 0); });
    const std::vector<std::size_t> effects = choose(half_of(whole, chooses));
    result.scored =
        static_cast<std::size_t>(std::ranges::count_if(second, [](char one) { return one != 0; }));
    result.runs = second.size() - result.scored;
    result.chosen = stats::contains(effects, selection.steps.front().effect);
    const Weights first = of_first(study, second);
    const Fitted none = fit(study.model(), {}, selection.none.fitted.state, first, kConfirmingEffort);
    if (!effects.empty()) {
        const auto freed = study.freed_by(effects);
        // From where all runs ended: a start, which the half's own fit leaves.
        const Fitted own = fit(study.model(), freed, selection.chosen.fitted.state, first, kConfirmingEffort);
        result.gain = cost_in(study, none.state, second) - cost_in(study, own.state, second);
    }
    const std::string halves = fmt::format("{} runs that chose and fitted it, {} that had no part in either",
                                           result.runs, result.scored);
    if (result.chosen && result.gain > kClearGain)
        result.sentence = fmt::format("Confirmed: {}; there it gains {:.3g} nats.", halves, result.gain);
    else if (result.chosen)
        result.sentence = fmt::format("Not confirmed: {}; there it gains {:.2g} nats, which chance may make.",
                                      halves, result.gain);
    else
        result.sentence =
            fmt::format("Not confirmed: the {} runs of one half alone do not choose it, so no run "
                        "is left that had no part in its choice. Record more of them.",
                        result.runs);
    return result;
}

}  // namespace puckloop::gap
