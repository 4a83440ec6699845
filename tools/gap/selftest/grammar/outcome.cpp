#include "tools/gap/selftest/grammar/outcome.h"

#include "gap/decide/ablation.h"
#include "gap/effects/effect.h"
#include "gap/fit/parallel.h"
#include "gap/pipeline/analyse.h"
#include "gap/stats/tails.h"
#include "tools/gap/selftest/case_list.h"
#include "tools/gap/selftest/grammar/families.h"
#include "tools/gap/selftest/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>

namespace puckloop::gap::selftest::grammar {

namespace {

Outcome run_one(std::size_t number, const Drawing& drawing) {
    const DrawnCase drawn = drawn_case(number, drawing.seed, drawing.draw_runs);
    const auto folder = drawing.scratch / fmt::format("case{:04}", number);
    write_folder(drawn.hidden.experiment, folder);
    Outcome outcome;
    try {
        Options analysis;
        analysis.seed = drawing.seed + number;
        const auto begin = std::chrono::steady_clock::now();
        outcome = outcome_of(drawn, analyse(read_experiment(folder), analysis));
        outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    } catch (const std::exception& error) {
        outcome = outcome_of(drawn, Verdict{});
        outcome.said = "error";
        outcome.error = error.what();
    }
    outcome.number = number;
    if (!drawing.keep) std::filesystem::remove_all(folder);
    return outcome;
}

}  // namespace

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
    for (const Cause& cause : verdict.causes)
        out.names.push_back(cause.name);
    const bool named = verdict.decision == Decision::Named && !out.names.empty();
    if (drawn.of == Class::Known) {
        const Judged judged = judge(drawn.hidden, verdict);
        out.right = judged.first_right;
        for (const Estimate& e : judged.estimates) {
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

std::vector<Outcome> run_drawn(const Drawing& drawing) {
    std::vector<std::size_t> numbers;
    for (std::size_t n = 0; n < drawing.cases; ++n) {
        const bool asked = drawing.only.empty() ||
                           std::find(drawing.only.begin(), drawing.only.end(), n) != drawing.only.end();
        const bool kind = drawing.kind.empty() || benches()[n % benches().size()]->kind() == drawing.kind;
        if (asked && kind && (!drawing.of || class_of(n) == *drawing.of)) numbers.push_back(n);
    }
    std::vector<Outcome> results(numbers.size());
    std::size_t finished = 0;
    std::mutex telling;
    in_parallel(numbers.size(), drawing.workers, [&](std::size_t k) {
        results[k] = run_one(numbers[k], drawing);
        const std::lock_guard lock(telling);
        if (drawing.done) drawing.done(results[k], ++finished, numbers.size());
    });
    return results;
}

}  // namespace puckloop::gap::selftest::grammar
