#include "gap/report/sections.h"

#include "base/pages/svg.h"
#include "gap/findings/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::gap::report {

namespace {

/// Does `puckloop run --model` take anything of what was found?
bool acts_in_a_run(const Verdict& verdict) {
    return std::any_of(verdict.causes.begin(), verdict.causes.end(), [](const Cause& cause) {
        return std::any_of(cause.parameters.begin(), cause.parameters.end(),
                           [](const FittedParameter& parameter) { return parameter.in_simulator; });
    });
}

void use_it(const Verdict& verdict, std::vector<std::string>& steps) {
    if (verdict.causes.empty()) return;
    steps.emplace_back(
        acts_in_a_run(verdict)
            ? "Simulate with it: puckloop run SCENARIO --model overlay.toml."
            : "Correct the measurement, not the simulator: [measurement] of overlay.toml has the numbers.");
    steps.emplace_back(
        "Confirm it before you rely on the name: record a few fresh runs, write the numbers into [nominal] "
        "of their experiment.toml and analyse them; the verdict has to be \"no effect\".");
}

void tell_apart(const Verdict& verdict, std::vector<std::string>& steps) {
    for (const Rival& rival : verdict.rivals)
        if (!rival.separated_by.empty()) {
            steps.push_back(fmt::format("Tell {} from {}: {}.",
                                        rival.instead_of.empty() ? "the first cause" : rival.instead_of,
                                        rival.cause.name, rival.separated_by));
            return;
        }
}

/// Runs, and what goes on within them, are no column that could be set.
bool can_be_varied(std::string_view covariate) {
    static const std::set<std::string_view> kGiven{
        "run", "time", "order", "previous sample", "predicted level", "spread per run"};
    return !kGiven.contains(covariate) && !covariate.ends_with(" a run");
}

void look_at_what_is_left(const Verdict& verdict, std::vector<std::string>& steps) {
    if (!verdict.leftovers.empty()) {
        const Leftover& left = verdict.leftovers.front();
        steps.push_back(fmt::format(
            "Look at {} against {}: {}. {}", plain_observable(left.observable), left.covariate, left.shape,
            can_be_varied(left.covariate)
                ? fmt::format("Vary {} alone, everything else held, in both directions.", left.covariate)
                : "No recorded column goes with it: repeat one run several times, and note what else changes "
                  "between and within runs (floor, battery, light, hands, other robots)."));
    } else if (!verdict.free_forms.empty() && verdict.free_forms.front().clear) {
        const FreeForm& form = verdict.free_forms.front();
        steps.push_back(fmt::format("Look at {}: {}.", plain_observable(form.observable), form.shape));
    }
    steps.emplace_back("Use no overlay: no parameter of the simulator stands for what was found.");
}

/// The best experiment; where others are as good, the laboratory may take the easiest.
void record_next(const Verdict& verdict, std::vector<std::string>& steps) {
    if (verdict.suggestions.empty()) return;
    const Suggestion& best = verdict.suggestions.front();
    std::string text = "Record next: " + best.what;
    for (const Suggestion& other : verdict.suggestions)
        if (&other != &best && other.rank == best.rank) text += "; or, as good: " + other.what;
    if (std::isnan(best.bits) && std::any_of(steps.begin(), steps.end(), [&](const std::string& one) {
            return one.find(best.what) != std::string::npos;
        }))
        return;  // the catalogue's advice, given above
    steps.push_back(std::move(text));
}

}  // namespace

std::string next_section(const Verdict& verdict) {
    std::vector<std::string> steps;
    if (!verdict.cautions.empty())
        steps.push_back(fmt::format(
            "Read the caution{} about the data below ({}): what the data cannot say, no verdict can.",
            verdict.cautions.size() == 1 ? "" : "s", verdict.cautions.size()));
    switch (verdict.decision) {
    case Decision::Named:
        use_it(verdict, steps);
        break;
    case Decision::CannotTell:
        tell_apart(verdict, steps);
        break;
    case Decision::Unexplained:
        look_at_what_is_left(verdict, steps);
        break;
    case Decision::NotIdentifiable:
        steps.emplace_back("Use no overlay: these data do not fix the number of any cause.");
        break;
    case Decision::NoEffect:
        steps.emplace_back("Nothing has to be changed: within the noise of these runs the simulator agrees.");
        break;
    }
    record_next(verdict, steps);
    std::string out = "<h2>What to do next</h2>\n<ol class=\"next\">\n";
    for (const std::string& step : steps)
        out += fmt::format("<li>{}</li>\n", escaped(step));
    return out + "</ol>\n";
}

}  // namespace puckloop::gap::report
