#include "gap/fit/select.h"

#include "gap/evidence/criterion.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit/parallel.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>

namespace puckloop::gap {

namespace {

using namespace thresholds;
using stats::contains;

// How much is looked at.
constexpr std::size_t kMostEffects = 5;
constexpr std::size_t kValidated = 3;     // best by BIC that are cross-validated
constexpr std::size_t kRefined = 5;       // best by a quick fit that are fitted to the end
constexpr std::size_t kLookedAt = 7;      // best on a part of many rows that are fitted to all
constexpr double kHopeless = 60.0;        // of BIC, by a quick fit: not fitted to the end
constexpr double kGlimpse = 0.125;        // of kPromising, nats that a pair wins at a glance (half is due)
constexpr double kLeastGlimpse = 1.5;     // nats of a part's rows, likewise: less is what any number gains
constexpr std::size_t kPairsOfMany = 2;   // best on a part of many rows that are fitted to all
constexpr std::size_t kPaired = 6;        // best alone that are tried two by two where none is enough
constexpr double kHopelessOnPart = 20.0;  // of BIC, of a part's rows

/// `effect` is put last, so that its starts are tried.
std::vector<std::size_t> with(std::vector<std::size_t> set, std::size_t effect) {
    set.push_back(effect);
    return set;
}

std::vector<std::size_t> without(std::vector<std::size_t> set, std::size_t effect) {
    std::erase(set, effect);
    return set;
}

/// A set that was tried, and by how much its BIC is better than that of the set it is compared with.
struct TriedSet {
    double won = -INFINITY;
    Fit fit;
    std::size_t effect() const { return fit.effects.back(); }
};

void best_first(std::vector<TriedSet>& all) {
    std::ranges::stable_sort(all, std::ranges::greater{}, &TriedSet::won);
}

}  // namespace

class Search::Steps {
  public:
    Steps(const Study& study, const Progress& progress) : study_(study), progress_(progress) {
        for (const Candidate& candidate : study.candidates())
            testable_ += candidate.remark.empty() ? 1 : 0;
    }

    double first() {
        report("fitting the simulator as it is", 0.02);
        result_.none = study_.fit_none();
        result_.held_none = study_.hold_out(result_.none);
        result_.chosen = result_.none;
        result_.held_chosen = result_.held_none;
        for (std::size_t i = 0; i < study_.candidates().size(); ++i)
            result_.trials.push_back({i, 0.0, {}, false, study_.candidates()[i].remark});
        more_ = step();
        double sum = 0.0;
        for (const auto& scores : result_.held_chosen.score)
            sum = std::accumulate(scores.begin(), scores.end(), sum);
        return sum;
    }

    Selection rest() {
        while (more_) {
            improve();
            more_ = result_.chosen.effects.size() < kMostEffects && step();
        }
        return std::move(result_);
    }

    void find_rivals(Selection& selection) {
        result_ = std::move(selection);
        report("looking for rivals", 0.8);
        look_at_part();
        std::vector<Draw> draws = draws_to_fit();
        in_parallel(draws.size(), study_.threads(), [&](std::size_t k) {
            Draw& draw = draws[k];
            if (draw.fit.effects.empty())
                draw.fit = in_its_place(draw.chosen, draw.rival, result_.chosen.bic + kDraw);
        });
        for (Draw& draw : draws) {
            draw.delta_bic = draw.fit.bic - result_.chosen.bic;
            if (!(draw.delta_bic <= kDraw)) continue;
            draw.held = study_.gain(study_.hold_out(draw.fit), result_.held_chosen);
            result_.draws.push_back(std::move(draw));
        }
        std::ranges::stable_sort(result_.draws, {}, [](const Draw& draw) {
            return std::pair(std::max(draw.delta_bic, kTie), draw.delta_bic < kTie ? draw.rival : 0);
        });
        selection = std::move(result_);
    }

  private:
    void report(const std::string& what, double share) const {
        if (progress_) progress_(what, share);
    }

    /// Reports the begin of one of `count` pieces of work that threads share, `part` of the whole together.
    void report_next(const std::string& what, double begin, double part, std::size_t count) {
        const std::lock_guard lock(reporting_);
        report(what, begin + part * static_cast<double>(begun_++) / static_cast<double>(count));
    }

    const Candidate& candidate(std::size_t effect) const { return study_.candidates()[effect]; }

    /// Effects that can be tried beside or in the place of a set.
    std::vector<std::size_t> others_than(const std::vector<std::size_t>& set) const {
        std::vector<std::size_t> others;
        for (std::size_t i = 0; i < study_.candidates().size(); ++i)
            if (candidate(i).remark.empty() && !contains(set, i)) others.push_back(i);
        return others;
    }

    void choose(Fit fit, HeldOut held) {
        result_.chosen = std::move(fit);
        result_.held_chosen = std::move(held);
    }

    /// How an effect did by itself.
    struct Alone {
        double won = 0.0;            ///< of BIC
        std::vector<double> values;  ///< where the parameters stood, if it won anything
    };

    /// A set that is fitted already, an effect to be put beside it, and the BIC that both have to better.
    struct Pair {
        const Fit* first;
        std::size_t second;
        double alone;
    };
    /// Both fitted quickly where a glance promises something, the best first.
    std::vector<TriedSet> together(std::vector<Pair> pairs) const {
        if (study_.part() != nullptr) pairs = promising_on_part(pairs);
        std::vector<TriedSet> all(pairs.size());
        in_parallel(pairs.size(), study_.threads(), [&](std::size_t k) {
            const State& from = pairs[k].first->fitted.state;
            const auto set = with(pairs[k].first->effects, pairs[k].second);
            if (study_.part() == nullptr && study_.glance(set, from) < kGlimpse * kPromising) return;
            Fit fit = study_.fit_set(set, from, kQuick);
            all[k] = {pairs[k].alone - fit.bic, std::move(fit)};
        });
        std::erase_if(all, [](const TriedSet& one) { return one.fit.effects.empty(); });
        best_first(all);
        return all;
    }

    /// Of many rows: the pairs that a part of them speaks for most, if it speaks for them at all.
    std::vector<Pair> promising_on_part(const std::vector<Pair>& pairs) const {
        const Study& part = *study_.part();
        const double rows = static_cast<double>(study_.rows()),
                     share = static_cast<double>(part.rows()) / rows;
        const double glimpse = std::max(share * kGlimpse * kPromising, kLeastGlimpse);
        std::map<const Fit*, Fit> firsts;  // on the part
        for (const Pair& pair : pairs)
            if (!firsts.contains(pair.first)) firsts[pair.first] = study_.on_part(*pair.first);
        std::vector<double> won(pairs.size(), -INFINITY);
        in_parallel(pairs.size(), study_.threads(), [&](std::size_t k) {
            const Fit& first = firsts.at(pairs[k].first);
            const auto set = with(first.effects, pairs[k].second);
            if (!part.candidates()[pairs[k].second].remark.empty()) {
                if (study_.glance(set, pairs[k].first->fitted.state) >= kGlimpse * kPromising)
                    won[k] = INFINITY;
                return;
            }
            if (part.glance(set, first.fitted.state) < glimpse) return;
            const Fit both = part.fit_set(set, first.fitted.state, kQuick);
            // As all rows would have it.
            won[k] = 2 * (both.fitted.log_likelihood - first.fitted.log_likelihood) / share -
                     static_cast<double>(both.freed.size() - first.freed.size()) * std::log(rows);
        });
        std::vector<std::size_t> order(pairs.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::erase_if(order, [&](std::size_t k) { return won[k] < kScreen; });
        std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t k) { return won[k]; });
        if (order.size() > kPairsOfMany) order.resize(kPairsOfMany);
        std::vector<Pair> best;
        for (const std::size_t k : order)
            best.push_back(pairs[k]);
        return best;
    }

    /// `state` with an effect where it stood when it was tried alone: beside another, a fit from nothing may
    /// not find it.
    State with_alone(std::size_t effect, State state) const {
        const auto known = alone_.find(effect);
        if (known == alone_.end() || known->second.values.empty()) return state;
        for (const Freed& freed : candidate(effect).freed)
            if (state.values[freed.index] == study_.model().parameters()[freed.index].neutral)
                state.values[freed.index] = known->second.values[freed.index];
        return state;
    }

    /// The one criterion, for `taken` effects more.
    bool enough(const Gain& gain, std::size_t taken = 1) const {
        return gains_enough(gain, testable_, taken);
    }

    /// An effect that explains much, and makes as many runs worse as better, may have a partner that pulls
    /// the other way where they meet. `first` is tried with each other effect, and both are taken or none.
    bool step_of_two(const TriedSet& first, const HeldOut& first_held, const Gain& first_gain) {
        if (first.fit.effects.size() >= kMostEffects) return false;
        std::vector<Pair> pairs;
        for (const std::size_t partner : others_than(first.fit.effects))
            pairs.push_back({&first.fit, partner, first.fit.bic});
        std::vector<TriedSet> tried = together(pairs);
        if (tried.empty()) return false;
        Fit& both = tried.front().fit;
        both = study_.refined(both);
        const double won = tried.front().won = first.fit.bic - both.bic;
        if (won < kScreen) return false;
        HeldOut held = study_.hold_out(both);
        if (!enough(study_.gain(result_.held_chosen, held), 2)) return false;
        result_.steps.push_back({first.effect(), first.won, first_gain, true, ""});
        result_.steps.push_back({both.effects.back(), won, study_.gain(first_held, held), true, ""});
        choose(both, std::move(held));
        last_step_of_choice_ = std::move(tried);
        return true;
    }

    /// Two effects that pull opposite ways nearly everywhere gain next to nothing alone. Where no effect is
    /// enough, the best are tried two by two; both are taken or none.
    bool step_of_opposites() {
        std::vector<Pair> pairs;
        const std::size_t count = std::min(last_step_.size(), kPaired);
        for (std::size_t a = 0; a < count; ++a)
            for (std::size_t b = a + 1; b < count; ++b)
                pairs.push_back({&last_step_[a].fit, last_step_[b].effect(),
                                 std::min(last_step_[a].fit.bic, last_step_[b].fit.bic)});
        std::vector<TriedSet> tried = together(pairs);
        if (tried.empty() || tried.front().won < kPromising) return false;
        Fit both = study_.refined(tried.front().fit);
        HeldOut held = study_.hold_out(both);
        if (!enough(study_.gain(result_.held_chosen, held), 2)) return false;
        for (const std::size_t effect : both.effects) {
            const auto alone = std::ranges::find_if(last_step_, [&](const TriedSet& one) {
                return one.effect() != effect && contains(both.effects, one.effect());
            });
            result_.steps.push_back({effect, alone->fit.bic - both.bic,
                                     study_.gain(study_.hold_out(alone->fit), held), true, ""});
        }
        choose(std::move(both), std::move(held));
        last_step_of_choice_ = std::move(tried);
        return true;
    }

    bool step() {
        const auto& chosen = result_.chosen;
        const double begin =
            0.05 + 0.2 * static_cast<double>(std::min<std::size_t>(chosen.effects.size(), 3));
        std::vector<std::size_t> tried = others_than(chosen.effects);
        std::map<std::size_t, Fit> guesses;
        if (study_.part() != nullptr) tried = promising(tried, begin, guesses);
        std::vector<TriedSet> fits(tried.size());
        begun_ = 0;
        in_parallel(tried.size(), study_.threads(), [&](std::size_t k) {
            report_next(fmt::format("trying {}", candidate(tried[k]).effect->name), begin, 0.15,
                        tried.size());
            const auto guess = guesses.find(tried[k]);
            Fit fit = guess == guesses.end()
                          ? study_.fit_set(with(chosen.effects, tried[k]),
                                           with_alone(tried[k], chosen.fitted.state), kQuick)
                          : study_.from_part(guess->second, chosen.fitted.state, kQuick);
            fits[k] = {chosen.bic - fit.bic, std::move(fit)};
        });
        best_first(fits);
        in_parallel(std::min(fits.size(), kRefined), study_.threads(), [&](std::size_t k) {
            if (fits[k].won < -kHopeless) return;
            fits[k].fit = study_.refined(fits[k].fit);
            fits[k].won = chosen.bic - fits[k].fit.bic;
        });
        best_first(fits);
        for (const TriedSet& one : fits) {
            Trial& trial = result_.trials[one.effect()];
            if (chosen.effects.empty() || !trial.validated) trial.delta_bic = one.won;
            if (!chosen.effects.empty()) continue;
            alone_[one.effect()].won = one.won;
            if (one.won > 0) alone_[one.effect()].values = one.fit.fitted.state.values;
        }
        last_step_ = fits;
        if (fits.size() > kValidated) fits.resize(kValidated);
        double best_gain = 0.0;
        std::size_t best = fits.size();
        std::vector<HeldOut> helds(fits.size());
        std::vector<Gain> gains(fits.size());
        for (std::size_t k = 0; k < fits.size(); ++k) {
            if (fits[k].won < kScreen) continue;
            helds[k] = study_.hold_out(fits[k].fit);
            gains[k] = study_.gain(result_.held_chosen, helds[k]);
            Trial& trial = result_.trials[fits[k].effect()];
            trial.held = gains[k];
            trial.validated = true;
            trial.delta_bic = fits[k].won;
            if (!enough(gains[k])) continue;
            // BIC is for how simply, the held-out score for how well: the sum of both decides.
            const double merit = gains[k].sum + fits[k].won / 2;
            // In a draw the sheet's order decides, which begins with what is met most often.
            const bool draw = best < fits.size() && std::abs(merit - best_gain) < kTie;
            const bool earlier = draw && fits[k].effect() < fits[best].effect();
            if (draw ? earlier : merit > best_gain) {
                best_gain = merit;
                best = k;
            }
        }
        if (best > 0 && fits.front().won > kPromising && !helds.front().score.empty() &&
            step_of_two(fits.front(), helds.front(), gains.front()))
            return true;
        if (best == fits.size()) return chosen.effects.empty() && step_of_opposites();
        last_step_of_choice_ = last_step_;
        result_.steps.push_back({fits[best].effect(), fits[best].won, gains[best], true, ""});
        choose(std::move(fits[best].fit), std::move(helds[best]));
        return true;
    }

    /// Of many rows: the effects that a part of them speaks for most, with their fits to the part. What the
    /// part gives for the others is taken for what all rows would.
    std::vector<std::size_t> promising(const std::vector<std::size_t>& tried, double begin,
                                       std::map<std::size_t, Fit>& guesses) {
        const auto& chosen = result_.chosen;
        const Study& part = *study_.part();
        const Fit before = study_.on_part(chosen);
        std::vector<Fit> fits(tried.size());
        begun_ = 0;
        in_parallel(tried.size(), study_.threads(), [&](std::size_t k) {
            const Candidate& own = part.candidates()[tried[k]];
            report_next(fmt::format("a first look at {}", own.effect->name), begin, 0.05, tried.size());
            if (own.remark.empty())
                fits[k] = part.fit_set(with(chosen.effects, tried[k]), before.fitted.state, kQuick);
        });
        std::vector<std::size_t> order, taken;
        for (std::size_t k = 0; k < tried.size(); ++k)
            (fits[k].effects.empty() ? taken : order).push_back(k);
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return fits[k].bic; });
        const double rows = static_cast<double>(study_.rows()), few = static_cast<double>(part.rows());
        for (const std::size_t k : order) {
            if (taken.size() < kLookedAt) {
                taken.push_back(k);
                guesses[tried[k]] = std::move(fits[k]);
                continue;
            }
            const double won = 2 * (fits[k].fitted.log_likelihood - before.fitted.log_likelihood),
                         parameters = static_cast<double>(fits[k].freed.size() - before.freed.size());
            Trial& trial = result_.trials[tried[k]];
            const double delta = won * rows / few - parameters * std::log(rows);
            if (!trial.validated) trial.delta_bic = delta;
            if (chosen.effects.empty()) alone_[tried[k]].won = delta;
        }
        std::ranges::sort(taken);
        std::vector<std::size_t> result;
        for (const std::size_t k : taken)
            result.push_back(tried[k]);
        return result;
    }

    /// After a choice an earlier one may have become needless, or another effect may stand better in its
    /// place.
    void improve() {
        if (result_.chosen.effects.size() < 2) return;
        report("looking back at earlier choices", 0.7);
        look_at_part();
        for (bool changed = true; changed;) {
            changed = false;
            for (const std::size_t effect : std::vector(result_.chosen.effects)) {
                if (result_.chosen.effects.size() < 2) break;
                const auto set = without(result_.chosen.effects, effect);
                if (needed_on_part(set, effect)) continue;
                Fit fit = study_.fit_set(set, study_.without(effect, result_.chosen.fitted.state));
                if (fit.bic > result_.chosen.bic + kClearBic) continue;
                HeldOut held = study_.hold_out(fit);
                if (enough(study_.gain(held, result_.held_chosen))) continue;
                choose(std::move(fit), std::move(held));
                std::erase_if(result_.steps, [&](const Trial& trial) { return trial.effect == effect; });
                look_at_part();
                changed = true;
            }
        }
        for (const std::size_t effect : std::vector(result_.chosen.effects)) {
            if (effect == result_.chosen.effects.back()) continue;
            std::vector<std::size_t> rivals = others_than(result_.chosen.effects);
            std::erase_if(rivals, [&](std::size_t rival) { return no_rival(rival, effect); });
            std::vector<Fit> fits(rivals.size());
            in_parallel(rivals.size(), study_.threads(), [&](std::size_t k) {
                fits[k] = in_its_place(effect, rivals[k], result_.chosen.bic - kDraw);
            });
            for (std::size_t k = 0; k < rivals.size(); ++k) {
                if (!(fits[k].bic <= result_.chosen.bic - kDraw)) continue;
                result_.chosen = std::move(fits[k]);
                result_.held_chosen = study_.hold_out(result_.chosen);
                for (Trial& trial : result_.steps)
                    if (trial.effect == effect) trial.effect = rivals[k];
                look_at_part();
                break;
            }
        }
    }

    void look_at_part() {
        if (study_.part() != nullptr) on_part_ = study_.on_part(result_.chosen).bic;
    }

    /// Of many rows: does already a part show clearly that the rest of the set is not enough?
    bool needed_on_part(const std::vector<std::size_t>& rest, std::size_t effect) const {
        if (study_.part() == nullptr || !study_.part()->candidates()[effect].remark.empty()) return false;
        const State from = study_.in_part(study_.without(effect, result_.chosen.fitted.state));
        return study_.part()->fit_set(rest, from).bic > on_part_ + kClearBic + kHopelessOnPart;
    }

    /// The chosen set with `rival` in the place of `effect`. Of many rows a part may show clearly that its
    /// BIC will not be as good as `good_enough`: then its BIC is infinite and nothing is fitted.
    Fit in_its_place(std::size_t effect, std::size_t rival, double good_enough) const {
        const auto set = with(without(result_.chosen.effects, effect), rival);
        const State from = study_.without(effect, result_.chosen.fitted.state);
        if (study_.part() == nullptr || !study_.part()->candidates()[rival].remark.empty())
            return study_.fit_set(set, from);
        Fit guess = study_.part()->fit_set(set, study_.in_part(from));
        if (guess.bic > on_part_ + (good_enough - result_.chosen.bic) + kHopelessOnPart) {
            guess.bic = INFINITY;
            return guess;
        }
        return study_.from_part(guess, from);
    }

    std::vector<Draw> draws_to_fit() {
        std::vector<Draw> draws;
        for (const std::size_t effect : result_.chosen.effects)
            for (const std::size_t rival : others_than(result_.chosen.effects)) {
                if (nested(rival, effect)) continue;
                if (!result_.trials[rival].remark.empty()) continue;  // it was heard, and let go
                Draw draw{effect, rival, 0.0, {}, {}};
                const bool last = effect == result_.chosen.effects.back() && known(rival, draw.fit);
                // An effect that alone said next to nothing of what the chosen one said is no rival of it.
                if (last || !no_rival(rival, effect)) draws.push_back(std::move(draw));
            }
        return draws;
    }

    bool no_rival(std::size_t rival, std::size_t effect) {
        return alone_[rival].won < kNoRival * alone_[effect].won;
    }

    /// The last step has tried `rival` in the place of the last choice.
    bool known(std::size_t rival, Fit& fit) const {
        const auto& chosen = result_.chosen.effects;
        for (const TriedSet& one : last_step_of_choice_) {
            const auto& set = one.fit.effects;
            if (set.size() != chosen.size() || set.back() != rival ||
                !std::equal(set.begin(), set.end() - 1, chosen.begin()))
                continue;
            fit = one.fit;
            return true;
        }
        return false;
    }

    /// Does `outer` fit all parameters that `inner` fits? Then it can predict the same, with more parameters.
    bool nested(std::size_t outer, std::size_t inner) const {
        const auto &a = candidate(outer).freed, &b = candidate(inner).freed;
        return std::ranges::all_of(b, [&](const Freed& one) {
            return std::ranges::any_of(a, [&](const Freed& other) { return other.index == one.index; });
        });
    }

    const Study& study_;
    const Progress& progress_;
    std::size_t testable_ = 0;
    bool more_ = false;
    Selection result_;
    std::map<std::size_t, Alone> alone_;  // of each effect that was tried at the first step
    double on_part_ = 0.0;                // BIC of the chosen set on the study's part
    std::vector<TriedSet> last_step_, last_step_of_choice_;
    std::mutex reporting_;
    std::size_t begun_ = 0;  // pieces of work
};

Search::Search(const Study& study, const Progress& progress)
    : steps_(std::make_unique<Steps>(study, progress)) {}
Search::~Search() = default;
double Search::first() {
    return steps_->first();
}
Selection Search::rest() {
    return steps_->rest();
}

void Search::find_rivals(Selection& selection) {
    steps_->find_rivals(selection);
}

}  // namespace puckloop::gap
