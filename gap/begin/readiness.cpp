#include "gap/begin/readiness.h"

#include "gap/begin/expected_time.h"
#include "gap/data/problems.h"
#include "gap/fit/study.h"
#include "gap/verdict/sentences.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>

namespace puckloop::gap {

namespace {

constexpr double kWithin = 3.0;  // factor: what is left and how many causes there are is not known before

}  // namespace

Readiness readiness_of(const std::filesystem::path& folder, unsigned threads) {
    Readiness ready;
    Problems problems;
    Experiment experiment;
    const bool read = attempt(&problems, [&] { experiment = survey_experiment(folder, problems); });
    ready.problems = problems.lines();
    if (!read) return ready;
    ready.title = experiment.title;
    ready.kind = kind_name(experiment.kind);
    ready.cautions = experiment.cautions;
    ready.runs = experiment.runs.size();
    ready.rows = experiment.rows();
    if (!ready.problems.empty()) return ready;
    attempt(&problems, [&] {  // [nominal] is the model's to check
        const Study study(experiment, 1, threads);
        for (const Candidate& candidate : study.candidates()) {
            if (candidate.remark.empty())
                ready.looked_for.emplace_back(candidate.effect->name);
            else
                ready.blind.push_back({candidate.effect->name, candidate.effect->title, candidate.remark});
        }
    });
    ready.problems = problems.lines();
    ready.seconds = expected_seconds(experiment, threads);
    return ready;
}

std::string readiness_text(const Readiness& ready) {
    std::string text;
    if (!ready.kind.empty())
        text +=
            fmt::format("{}: kind {}, {} runs, {} rows\n", ready.title, ready.kind, ready.runs, ready.rows);
    for (const auto& problem : ready.problems)
        text += fmt::format("wrong: {}\n", problem);
    for (const auto& caution : ready.cautions)
        text += fmt::format("caution: {}\n", caution);
    if (!ready.problems.empty())
        return text + fmt::format("not ready: {} thing{} to put right, then check again\n",
                                  ready.problems.size(), ready.problems.size() == 1 ? "" : "s");
    std::map<std::string, std::vector<std::string>> by_reason;
    for (const auto& blind : ready.blind)
        by_reason[plain_remark(blind.why)].push_back(blind.name);
    for (const auto& [why, names] : by_reason)
        text += fmt::format("cannot be found: {} ({})\n", fmt::join(names, ", "), why);
    text += fmt::format("can be found: {}\n", fmt::join(ready.looked_for, ", "));
    return text +
           fmt::format(
               "ready: a verdict takes {} ({:.0f} to {:.0f} s); what is named is then performed again, which "
               "takes longer (--no-rerun: not)\n",
               rough_time(ready.seconds), std::floor(ready.seconds / kWithin),
               std::ceil(ready.seconds * kWithin));
}

}  // namespace puckloop::gap
