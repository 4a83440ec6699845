#include "gap/fit/study.h"

#include "gap/kinds/columns.h"
#include "gap/fit/objective.h"
#include "gap/fit/parallel.h"
#include "gap/fit/thinned.h"
#include "gap/stats/exchange.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <tuple>

namespace puckloop::gap {

namespace {

constexpr double kLittleDrift = -9.0;  // ln of drift variance over noise variance
constexpr std::size_t kMostFolds = 5;
constexpr std::size_t kLeastBlocks = 16;  // fewer independent blocks make no interval
constexpr std::size_t kEnoughRuns = 6;    // then runs are the blocks: parts of one share its day and place
constexpr std::size_t kLeastBlockRows = 8;

constexpr double kHeavyTail = 2.5, kLightTail = 20;  // degrees of freedom to begin at
constexpr double kLightEnough = 8;                   // degrees of freedom that hide nothing
constexpr int kMostRounds = 6;                       // of fitting the noise alone
constexpr double kSettled = 0.1;                     // nats that a round must bring

constexpr double kLongMemory = 0.5;  // share of a sum's errors that is kept: beyond, something else may be
constexpr std::size_t kManyRows = 6000;  // beyond, fits are begun on a part of them
constexpr std::size_t kPartRows = 3000;

bool varies(const Experiment& experiment, std::string_view column) {
    const stats::Range all = experiment.range(column);
    return all.high > all.low;
}

/// What was done in a run, roughly: of each column that was set up or is true, whether it is nothing, one
/// value, or several.
std::string design_of(const Kind& kind, const Run& run) {
    std::string design;
    for (const ColumnInfo& info : columns_of(kind)) {
        if (info.role != Role::Stimulus && info.role != Role::Truth) continue;
        stats::Range own;
        own.take(run.column(info.name));
        const bool nothing = own.empty() || (own.low == 0.0 && own.high == 0.0);
        design += nothing ? '0' : own.low == own.high ? '1' : 'n';
    }
    return design;
}

/// One effect's parameter on one index of the model.
Freed freed_at(const Model& model, const EffectParameter& parameter, std::size_t index) {
    const double neutral = model.parameters()[index].neutral;
    Freed freed{index,   parameter.low,        parameter.high,      parameter.prior_sd,
                neutral, parameter.resolution, parameter.threshold, parameter.possible};
    const bool within = neutral >= parameter.low && neutral <= parameter.high;
    if (!within && neutral == 0.0) {  // off
        freed.centre =
            parameter.starts.empty() ? (parameter.low + parameter.high) / 2 : parameter.starts.front();
    } else if (!within) {  // another robot altogether: as wide about its own number
        freed.low = std::min(freed.low, neutral - 3 * parameter.prior_sd);
        freed.high = std::max(freed.high, neutral + 3 * parameter.prior_sd);
    }
    return freed;
}

}  // namespace

Study::Study(const Experiment& experiment, std::uint64_t seed, unsigned threads, MotionView view)
    : experiment_(experiment), view_(view), model_(make_model(experiment, view)), threads_(threads) {
    make_candidates();
    make_folds(seed);
    if (experiment.rows() > kManyRows) make_part();
}

Study::Study(std::unique_ptr<Experiment> thin, const Study& whole)
    : own_(std::move(thin)), experiment_(*own_), view_(whole.view_), model_(make_model(experiment_, view_)) {
    take_candidates(whole);
}

void Study::make_part() {
    std::unique_ptr<Study> part(
        new Study(std::make_unique<Experiment>(thinned(experiment_, kPartRows)), *this));
    const auto &own = model_->observables(), &others = part->model().observables();
    const auto alike = [](const Observable& a, const Observable& b) {
        return a.name == b.name && noise_parameters(a) == noise_parameters(b) && !b.y.empty();
    };
    if (!std::equal(own.begin(), own.end(), others.begin(), others.end(), alike)) return;
    for (const ModelParameter& parameter : model_->parameters())
        place_in_part_.push_back(part->model().find(parameter.name));
    part_ = std::move(part);
}

void Study::take_candidates(const Study& whole) {
    for (const Candidate& theirs : whole.candidates_) {
        Candidate own;
        own.effect = theirs.effect;
        own.remark = theirs.remark;
        own.starts.resize(theirs.starts.size());
        for (std::size_t j = 0; j < theirs.freed.size(); ++j) {
            Freed freed = theirs.freed[j];
            const auto index = model_->find(whole.model_->parameters()[freed.index].name);
            if (!index) continue;
            freed.index = *index;
            own.freed.push_back(freed);
            for (std::size_t k = 0; k < theirs.starts.size(); ++k)
                own.starts[k].push_back(theirs.starts[k][j]);
        }
        if (own.remark.empty() && (own.freed.empty() || moved_by(own).empty()))
            own.remark = "not in this part";
        candidates_.push_back(std::move(own));
    }
}

State Study::in_part(const State& whole) const {
    State part{part_->model().neutral(), whole.noise};
    for (std::size_t i = 0; i < place_in_part_.size(); ++i)
        if (place_in_part_[i]) part.values[*place_in_part_[i]] = whole.values[i];
    return part;
}

Fit Study::on_part(const Fit& whole) const {
    return part_->refined({whole.effects, {in_part(whole.fitted.state)}, part_->freed_by(whole.effects)});
}

Fit Study::from_part(const Fit& guess, const State& from, const Effort& effort) const {
    State begin{from.values, guess.fitted.state.noise};
    for (std::size_t i = 0; i < place_in_part_.size(); ++i)
        if (place_in_part_[i]) begin.values[i] = guess.fitted.state.values[*place_in_part_[i]];
    Fit whole;
    whole.effects = guess.effects;
    whole.freed = freed_by(guess.effects);
    whole.fitted = fit(*model_, whole.freed, begin, {}, effort);
    whole.bic = bic_of(whole.fitted, whole.freed.size());
    return whole;
}

std::string Study::missing_for(const Effect& effect) const {
    std::vector<std::string> missing;
    for (std::string_view need : effect.needs) {
        const bool may_stand = need.starts_with('+');
        if (may_stand) need.remove_prefix(1);
        bool varies_one = false;
        std::string there;  // and does not vary
        std::stringstream names{std::string(need)};
        for (std::string name; std::getline(names, name, '|');) {
            varies_one = varies_one || varies(experiment_, name);
            if (there.empty() && experiment_.has(name)) there = name;
        }
        if (varies_one || (may_stand && !there.empty())) continue;
        if (may_stand)
            missing.push_back(fmt::format("{} to be recorded", need));
        else if (there.empty())
            missing.push_back(fmt::format("{} to be recorded and to vary", need));
        else
            missing.push_back(
                fmt::format("{} to vary, which is {:g} in every row", there, experiment_.range(there).low));
    }
    return missing.empty() ? "" : fmt::format("needs {}", fmt::join(missing, "; and "));
}

std::vector<std::size_t> Study::moved_by(const Candidate& candidate) const {
    const Prediction neutral = model_->predicted(model_->neutral());
    auto places = candidate.starts;
    for (const double sign : {1.0, -1.0}) {
        std::vector<double> place;
        for (const Freed& one : candidate.freed)
            place.push_back(std::clamp(one.centre + sign * one.prior_sd, one.low, one.high));
        places.push_back(std::move(place));
    }
    std::set<std::size_t> moved;
    for (const std::vector<double>& place : places) {
        std::vector<double> values = model_->neutral();
        for (std::size_t j = 0; j < place.size(); ++j)
            values[candidate.freed[j].index] = place[j];
        const Prediction there = model_->predicted(values);
        for (std::size_t o = 0; o < there.size(); ++o)
            if (there[o] != neutral[o]) moved.insert(o);
    }
    return {moved.begin(), moved.end()};
}

void Study::make_candidates() {
    for (const Effect* effect : effects_of(experiment_.kind)) {
        Candidate candidate;
        candidate.effect = effect;
        candidate.remark = missing_for(*effect);
        std::vector<std::vector<double>> own;  // starts of each freed parameter
        std::size_t rounds = 1;
        for (const EffectParameter& parameter : effect->parameters) {
            if (parameter.unless != nullptr && model_->find(parameter.unless)) continue;
            for (const std::size_t index : model_->matching(parameter.name)) {
                candidate.freed.push_back(freed_at(*model_, parameter, index));
                own.push_back(parameter.starts);
                if (candidate.remark.empty())
                    for (const double start : model_->starts(model_->parameters()[index].name))
                        own.back().push_back(start);
                rounds = std::max(rounds, own.back().size());
            }
        }
        for (std::size_t round = 0; round < rounds; ++round) {
            std::vector<double> start;
            for (std::size_t j = 0; j < candidate.freed.size(); ++j)
                start.push_back(own[j].empty() ? candidate.freed[j].centre
                                               : own[j][std::min(round, own[j].size() - 1)]);
            candidate.starts.push_back(std::move(start));
        }
        if (candidate.remark.empty() && (candidate.freed.empty() || moved_by(candidate).empty()))
            candidate.remark = "nothing in this data depends on it";
        candidates_.push_back(std::move(candidate));
    }
}

void Study::make_folds(std::uint64_t seed) {
    const std::size_t runs = experiment_.runs.size();
    const bool by_run = runs >= 3;
    folds_ = by_run ? std::min(kMostFolds, runs) : kMostFolds;
    RandomStream random(seed, "gap/folds");
    std::vector<std::size_t> order = stats::random_order(runs, random);
    // Repeats of one condition, and among them of one design, are dealt to different folds: what only they
    // show could not be learnt from the others.
    std::vector<std::string> design;
    for (const Run& run : experiment_.runs)
        design.push_back(design_of(experiment_.kind, run));
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return std::tie(experiment_.runs[a].conditions, design[a]) <
               std::tie(experiment_.runs[b].conditions, design[b]);
    });
    std::vector<std::size_t> place(runs);
    for (std::size_t i = 0; i < runs; ++i)
        place[order[i]] = i;
    const std::size_t pieces =
        runs >= kEnoughRuns ? 1 : (kLeastBlocks + runs - 1) / std::max<std::size_t>(runs, 1);
    blocks_.count = runs * pieces;
    for (const Observable& observable : model_->observables()) {
        std::vector<int> fold;
        std::vector<std::uint32_t> block;
        for (std::size_t i = 0; i < observable.y.size(); ++i) {
            const Run& run = experiment_.runs[observable.run[i]];
            const std::size_t piece =
                std::min(pieces - 1, observable.row[i] * pieces / std::max<std::size_t>(run.rows, 1));
            block.push_back(static_cast<std::uint32_t>(observable.run[i] * pieces + piece));
            const std::size_t stretch = observable.row[i] * folds_ / std::max<std::size_t>(run.rows, 1);
            fold.push_back(static_cast<int>(by_run ? place[observable.run[i]] % folds_ : stretch));
        }
        fold_.push_back(std::move(fold));
        blocks_.of.push_back(std::move(block));
    }
}

std::vector<Freed> Study::freed_by(const std::vector<std::size_t>& effects) const {
    std::vector<Freed> all;
    for (const std::size_t e : effects)
        for (const Freed& freed : candidates_[e].freed) {
            if (std::ranges::none_of(all, [&](const Freed& other) { return other.index == freed.index; }))
                all.push_back(freed);
        }
    return all;
}

Fit Study::fit_none() const {
    if (part_) return from_part(part_->fit_none(), neutral_state(*model_));
    Fit result;
    result.fitted = fit(*model_, {}, neutral_state(*model_), {});
    // Noise far from its first guess may stop at a bound; what it lacked would be credited to the first
    // effect.
    bool won = true;
    for (int round = 0; won && round < kMostRounds; ++round) {
        won = false;
        for (const double narrower : {0.0, 0.9, -0.9}) {
            State start = result.fitted.state;
            for (std::size_t o = 0; o < start.noise.size(); ++o) {
                if (noise_parameters(model_->observables()[o]) == 0) continue;
                start.noise[o].log_sd -= narrower;
                if (narrower != 0.0)
                    start.noise[o].log_tail = std::log(narrower > 0 ? kHeavyTail : kLightTail);
            }
            Fitted better = fit(*model_, {}, start, {});
            if (better.log_likelihood < result.fitted.log_likelihood + kSettled) continue;
            result.fitted = std::move(better);
            won = true;
        }
    }
    result.bic = -2 * result.fitted.log_likelihood;
    return result;
}

/// The start, or the same way at a tenth, a hundredth, ...: whatever the rows like best. A fit that begins
/// where nothing fits does not find back.
State Study::begun(const Candidate& candidate, const std::vector<double>& start, const State& from) const {
    State best = from;
    double best_score = -INFINITY;
    for (const double share : {1.0, 0.3, 0.1, 0.03, 0.01, 0.001}) {
        State state = from;
        bool moved = false;
        for (std::size_t j = 0; j < candidate.freed.size(); ++j) {
            const auto index = candidate.freed[j].index;
            const double neutral = model_->parameters()[index].neutral;
            const bool scalable = neutral >= candidate.freed[j].low && neutral <= candidate.freed[j].high;
            state.values[index] = scalable ? neutral + share * (start[j] - neutral) : start[j];
            moved = moved || (scalable && start[j] != neutral);
        }
        const double score = log_likelihood(*model_, state);
        if (score > best_score) {
            best_score = score;
            best = std::move(state);
        }
        if (!moved) break;
    }
    return best;
}

Fit Study::fit_set(const std::vector<std::size_t>& effects, const State& from, const Effort& effort) const {
    Fit best;
    best.effects = effects;
    best.freed = freed_by(effects);
    best.bic = INFINITY;
    const Candidate& last = candidates_[effects.back()];
    // A set with one effect more can do what the set without it does. A fit that ends below where it came
    // from went astray, and begins again there.
    const double parent = bic_of({from, log_likelihood(*model_, from)}, best.freed.size());
    const auto restarted = [&](Fit end) {
        if (!(end.bic > parent)) return end;
        end.fitted = fit(*model_, end.freed, from, {}, effort);
        end.bic = bic_of(end.fitted, end.freed.size());
        return end;
    };
    if (part_ && part_->candidates_[effects.back()].remark.empty())
        return restarted(from_part(part_->fit_set(effects, in_part(from), kQuick), from, effort));
    const auto take_better = [&](const State& state, const Effort& how) {
        const Fitted fitted = fit(*model_, best.freed, state, {}, how);
        const double bic = bic_of(fitted, best.freed.size());
        if (!(bic < best.bic)) return;
        best.bic = bic;
        best.fitted = fitted;
    };
    // A sum's drift would swallow what the effect explains: it has to earn itself anew.
    std::vector<NoiseParameters> calm = from.noise;
    bool drifts = false;
    for (std::size_t o = 0; o < calm.size(); ++o) {
        const Observable& one = model_->observables()[o];
        if (!adds_up(one) || one.fixed_sd > 0) continue;
        drifts = drifts || calm[o].carry > kLittleDrift;
        calm[o].carry = std::min(calm[o].carry, kLittleDrift);
    }
    // All starts quickly, the best to the end.
    for (const auto& start : last.starts) {
        State state = begun(last, start, from);
        state.noise = calm;
        take_better(state, kQuick);
        if (lighten_tails(state)) take_better(fit(*model_, best.freed, state, {}, kPart).state, kQuick);
    }
    // Where another effect was dropped or replaced, this one already stands somewhere.
    const bool stands = std::ranges::any_of(last.freed, [&](const Freed& freed) {
        return from.values[freed.index] != model_->parameters()[freed.index].neutral;
    });
    if (stands) take_better(from, kQuick);
    // A sum that really drifts cannot be begun without its drift.
    if (drifts) take_better(begun(last, last.starts.front(), from), kQuick);
    if (effort.iterations > kQuick.iterations) take_better(best.fitted.state, effort);
    return restarted(best);
}

double Study::glance(const std::vector<std::size_t>& effects, const State& from) const {
    const Candidate& last = candidates_[effects.back()];
    const auto freed = freed_by(effects);
    const double before = log_likelihood(*model_, from);
    return fit(*model_, freed, begun(last, last.starts.front(), from), {}, kGlance).log_likelihood - before;
}

State Study::without(std::size_t effect, State state) const {
    for (const Freed& freed : candidates_[effect].freed)
        state.values[freed.index] = model_->parameters()[freed.index].neutral;
    return state;
}

/// Heavy tails take rows that an effect explains for outliers, which then pull at nothing, and a sum's errors
/// that are kept for long take pushes for themselves.
bool Study::lighten_tails(State& state) const {
    bool any = false;
    for (std::size_t o = 0; o < state.noise.size(); ++o) {
        const Observable& one = model_->observables()[o];
        if (noise_parameters(one) == 0) continue;
        NoiseParameters& noise = state.noise[o];
        if (std::exp(noise.log_tail) > kLightEnough) continue;
        any = true;
        if (adds_up(one) && noise.memory > kLongMemory)
            noise = first_guess(one, model_->predicted(state.values)[o]);
        noise.log_tail = std::log(kLightTail);
    }
    return any;
}

Fit Study::refined(const Fit& quick) const {
    Fit fit_again = quick;
    fit_again.fitted = fit(*model_, quick.freed, quick.fitted.state, {});
    fit_again.bic = bic_of(fit_again.fitted, quick.freed.size());
    return fit_again;
}

std::size_t Study::rows() const {
    std::size_t sum = 0;
    for (const Observable& observable : model_->observables())
        sum += observable.y.size();
    return sum;
}

double Study::bic_of(const Fitted& fitted, std::size_t parameters) const {
    return -2 * fitted.log_likelihood +
           static_cast<double>(parameters) * std::log(static_cast<double>(std::max<std::size_t>(rows(), 2)));
}

Fitted Study::without_fold(std::size_t fold, const Fit& whole, const Effort& effort) const {
    Weights others;
    for (const auto& folds : fold_) {
        others.emplace_back();
        for (const int own : folds)
            others.back().push_back(own != static_cast<int>(fold) ? 1.0 : 0.0);
    }
    return fit(*model_, whole.freed, whole.fitted.state, others, effort);
}

HeldOut Study::hold_out(const Fit& whole, const Effort& effort) const {
    HeldOut held;
    const auto& observables = model_->observables();
    for (const Observable& observable : observables) {
        held.score.emplace_back(observable.y.size(), 0.0);
        held.mean.emplace_back(observable.y.size(), 0.0);
    }
    in_parallel(folds_, threads_, [&](std::size_t k) {
        const Fitted part = without_fold(k, whole, effort);
        const Prediction prediction = model_->predicted(part.state.values);
        const auto costs = costs_at(*model_, part.state, prediction);
        // What the noise loses for being off the simulator's claim is lost by every row alike.
        std::vector<double> off;
        for (std::size_t o = 0; o < observables.size(); ++o)
            off.push_back(std::pow(claim_error(observables[o], part.state.noise[o]), 2) /
                          (2 * static_cast<double>(std::max<std::size_t>(observables[o].y.size(), 1))));
        for (std::size_t o = 0; o < observables.size(); ++o)
            for (std::size_t i = 0; i < fold_[o].size(); ++i)
                if (fold_[o][i] == static_cast<int>(k)) {
                    held.score[o][i] = -costs[o].cost[i] - off[o];
                    held.mean[o][i] = shown(prediction[o], i);
                }
    });
    return held;
}

Gain Study::gain(const HeldOut& before, const HeldOut& after, std::optional<std::size_t> observable) const {
    std::vector<double> by_block(blocks_.count, 0.0);
    for (std::size_t o = 0; o < blocks_.of.size(); ++o) {
        if (observable && o != *observable) continue;
        for (std::size_t i = 0; i < blocks_.of[o].size(); ++i)
            by_block[blocks_.of[o][i]] += after.score[o][i] - before.score[o][i];
    }
    return gain_of(by_block);
}

}  // namespace puckloop::gap
