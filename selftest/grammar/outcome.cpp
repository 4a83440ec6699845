#include "selftest/grammar/outcome.h"

#include "gap/effects/effect.h"
#include "gap/stats/tails.h"
#include "selftest/grammar/ablation.h"
#include "selftest/grammar/families.h"
#include "selftest/grammar/noisy_inputs.h"
#include "selftest/run_cases.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::gap::selftest::grammar {

double rank_in(double truth, double value, double low, double high) {
    constexpr double kHalf = 1.6449;  // sd from the middle to the end of a 90 % interval
    const double sd = (truth > value ? high - value : value - low) / kHalf;
    if (!(sd > 0)) return truth > value ? 1.0 : 0.0;
    return 1.0 - stats::normal_tail((truth - value) / sd);
}

Outcome outcome_of(const DrawnCase& drawn, const Verdict& verdict) {
    Outcome out;
    out.of = drawn.of;
    out.kind = drawn.hidden.kind;
    out.text = drawn.text;
    out.family = drawn.family;
    if (!drawn.hidden.labels.empty()) out.effect = drawn.hidden.labels.front();
    out.asked = drawn.asked;
    out.ratio = drawn.hidden.ratio;
    out.likeness = drawn.likeness;
    out.runs = drawn.runs;
    out.redrawn = drawn.redrawn;
    out.said = std::string(decision_name(verdict.decision));
    out.alone_against = alone_against(verdict.grounds);
    out.enough_against = enough_against(verdict.grounds);
    for (const Cause& cause : verdict.causes)
        out.names.push_back(cause.name);
    const bool named = verdict.decision == Decision::Named && !out.names.empty();
    if (drawn.of == Class::Known) {
        const Judged judged = judge(drawn.hidden, verdict);
        out.right = judged.first_right;
        out.estimates = judged.estimates;
        for (const Estimate& e : out.estimates) {
            out.ranks.push_back(rank_in(e.truth, e.value, e.low, e.high));
            out.covered += e.covered() ? 1 : 0;
        }
    }
    if (drawn.of == Class::NearMiss && named) {
        const std::string_view family = family_of(out.names.front());
        out.other_family = family != drawn.family;
        // With another covariate it may be what another effect of the catalogue does: that name is not wrong.
        out.wrong_family =
            out.other_family && std::none_of(drawn.alike.begin(), drawn.alike.end(), [&](int number) {
                return std::any_of(catalogue().begin(), catalogue().end(), [&](const Effect& effect) {
                    return effect.number == number && family_of(effect.name) == family;
                });
            });
    }
    return out;
}

namespace {

std::vector<std::size_t> numbers_of(const Drawing& drawing) {
    std::vector<std::size_t> numbers;
    for (std::size_t n = 0; n < drawing.cases; ++n) {
        const bool asked = drawing.only.empty() ||
                           std::find(drawing.only.begin(), drawing.only.end(), n) != drawing.only.end();
        const bool kind = drawing.kind.empty() || benches()[n % benches().size()]->kind() == drawing.kind;
        if (asked && kind && (!drawing.of || *drawing.of == Class::NoisyInput || class_of(n) == *drawing.of))
            numbers.push_back(n);
    }
    return numbers;
}

Outcome tried(const Drawing& drawing, std::size_t number, const DrawnCase& drawn, const std::string& folder) {
    const auto said = analysed(drawn.hidden.experiment, drawing.scratch / folder, drawing.seed + number,
                               drawing.keep, drawing.ask_all);
    Outcome outcome = outcome_of(drawn, said.verdict);
    outcome.number = number;
    outcome.wall_s = said.wall_s;
    outcome.error = said.error;
    if (!said.error.empty()) outcome.said = "error";
    return outcome;
}

}  // namespace

std::vector<Outcome> run_drawn(const Drawing& drawing) {
    const auto numbers = numbers_of(drawing);
    const bool noisy = drawing.of == Class::NoisyInput;
    const auto one = [&](std::size_t k) {
        const DrawnCase drawn = noisy ? noisy_input_case(numbers[k], drawing.seed)
                                      : drawn_case(numbers[k], drawing.seed, drawing.draw_runs);
        return tried(drawing, numbers[k], drawn, fmt::format("case{:04}", numbers[k]));
    };
    return run_all(numbers.size(), drawing.workers, one,
                   [&](std::size_t, const Outcome& outcome, std::size_t done) {
                       if (drawing.done) drawing.done(outcome, done, numbers.size());
                   });
}

std::vector<Outcome> run_power(const Drawing& drawing) {
    const auto numbers = numbers_of(drawing);
    const auto one = [&](std::size_t k) {
        const DrawnCase drawn = drawn_case(numbers[k], drawing.seed, false, kPowerRuns.back());
        std::vector<Outcome> outcomes;
        for (const std::size_t runs : kPowerRuns)
            outcomes.push_back(tried(drawing, numbers[k], with_runs(drawn, runs, drawing.seed + numbers[k]),
                                     fmt::format("case{:04}", numbers[k])));
        return outcomes;
    };
    const auto each = run_all(numbers.size(), drawing.workers, one,
                              [&](std::size_t, const std::vector<Outcome>& outcomes, std::size_t done) {
                                  for (const Outcome& outcome : outcomes)
                                      if (drawing.done) drawing.done(outcome, done, numbers.size());
                              });
    std::vector<Outcome> all;
    for (const auto& outcomes : each)
        all.insert(all.end(), outcomes.begin(), outcomes.end());
    return all;
}

}  // namespace puckloop::gap::selftest::grammar
