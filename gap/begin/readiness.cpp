#include "gap/begin/readiness.h"

#include "gap/data/problems.h"
#include "gap/fit/study.h"
#include "gap/reading/read_experiment.h"
#include "gap/stats/series.h"
#include "gap/verdict/sentences.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kWithin = 2.0;      // factor: what is left and how many causes there are is not known before
constexpr double kManyCauses = 3.5;  // of a drive more: published ones have four and more of them

/// "frame_ok is 1 in every row", where all that a cause could change is an event that was always alike; else
/// empty.
std::string never_happened(const Study& study, const Candidate& candidate) {
    std::vector<std::string> events;
    for (const std::size_t o : study.moved_by(candidate)) {
        const Observable& one = study.model().observables()[o];
        if (one.noise != NoiseKind::Event || one.y.empty() || stats::varies(one.y)) return {};
        events.push_back(fmt::format("{} is {:g} in every row", one.name, one.y.front()));
    }
    return fmt::format("{}", fmt::join(events, ", "));
}

}  // namespace

Readiness readiness_of(const std::filesystem::path& folder, unsigned threads) {
    Readiness ready;
    Problems problems;
    problems.attempt([&] { ready.experiment = survey_experiment(folder, problems); });
    if (problems.empty())
        problems.attempt([&] {  // [nominal] is the model's to check
            const Study study(*ready.experiment, 1, threads);
            for (const Candidate& candidate : study.candidates()) {
                const std::string absent = candidate.remark.empty() ? never_happened(study, candidate) : "";
                auto& causes = !candidate.remark.empty() ? ready.blind[plain_remark(candidate.remark)]
                               : !absent.empty()         ? ready.absent[absent]
                                                         : ready.looked_for;
                causes.emplace_back(candidate.effect->name);
            }
            ready.seconds = expected_time(*ready.experiment, threads);
        });
    ready.problems = problems.lines();
    return ready;
}

std::string readiness_text(const Readiness& ready) {
    std::string text;
    if (ready.experiment)
        text += fmt::format("{}: kind {}, {} runs, {} rows\n", ready.experiment->title,
                            kind_name(ready.experiment->kind), ready.experiment->runs.size(),
                            ready.experiment->rows());
    for (const auto& problem : ready.problems)
        text += fmt::format("wrong: {}\n", problem);
    if (ready.experiment)
        for (const auto& caution : ready.experiment->cautions)
            text += fmt::format("caution: {}\n", caution);
    if (!ready.problems.empty())
        return text + fmt::format("not ready: {} thing{} to put right, then check again\n",
                                  ready.problems.size(), ready.problems.size() == 1 ? "" : "s");
    for (const auto& [why, names] : ready.blind)
        text += fmt::format("cannot be found: {} ({})\n", fmt::join(names, ", "), why);
    for (const auto& [why, names] : ready.absent)
        text += fmt::format("did not happen: {} ({})\n", fmt::join(names, ", "), why);
    text += fmt::format("can be found: {}\n", fmt::join(ready.looked_for, ", "));
    const double many = ready.experiment && ready.experiment->kind == Kind::Motion ? kManyCauses : 1.0;
    return text + fmt::format("ready: a verdict takes {} where nothing is wrong, {} where something is "
                              "({:.0f} to {:.0f} s); "
                              "what is named is then performed again, which takes longer (--no-rerun: not)\n",
                              rough_time(ready.seconds.nothing), rough_time(ready.seconds.something),
                              std::floor(ready.seconds.nothing / kWithin),
                              std::ceil(ready.seconds.something * kWithin * many));
}

}  // namespace puckloop::gap
