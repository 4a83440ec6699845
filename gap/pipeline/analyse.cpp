// The stages after an experiment is read, checked, cleaned and synchronised (gap/data): fit and select,
// diagnose, decide, report. Each is a function of what the ones before it returned.

#include "gap/pipeline/analyse.h"

#include "gap/diagnostics/agenda.h"
#include "gap/pipeline/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace puckloop::gap {

namespace {

Asked asked(const Experiment& half, const Options& options, MotionView view);
std::vector<std::size_t> chosen_on(const Experiment& half, const Options& options, MotionView view);

/// An experiment from one view. The first step of the search stands by itself, since views compete by it.
class Analysis {
  public:
    Analysis(const Experiment& experiment, const Options& options, MotionView view)
        : options_(options),
          view_(view),
          study_(experiment, options.seed, options.threads, view),
          search_(study_, options_.progress) {}

    /// Log score of held-out rows after the first step.
    double first() { return search_.first(); }

    /// After first(); once. `confirms`: also by the other half of the runs.
    Judged decided(bool confirms) {
        Chosen chosen = chosen_of(study_, search_.rest());
        report("what is left", 0.88);
        Diagnosis diagnosis = diagnosed(study_, chosen, options_.seed);
        Judging how{options_.seed, options_.ask_all, {}};
        if (confirms)
            how.ask = [&](const Experiment& half) {
                report("asking the other half of the runs", 0.92);
                return asked(half, options_, view_);
            };
        return judged(study_, std::move(chosen), std::move(diagnosis), how);
    }

    Verdict verdict() {
        Judged judged = decided(true);
        if (judged.decision == Decision::Named) {
            search_.find_rivals(judged.chosen.selection);
            report("choosing on half of the runs", 0.94);
            judged.confirmation =
                confirmation_of(study_, judged.chosen.selection,
                                [&](const Experiment& half) { return chosen_on(half, options_, view_); });
        }
        report("intervals", 0.96);
        return verdict_of(study_, std::move(judged), options_.seed);
    }

    /// After first(); once: what is selected, not judged.
    std::vector<std::size_t> chosen() { return search_.rest().chosen.effects; }

    const Effect& effect(std::size_t candidate) const { return *study_.candidates()[candidate].effect; }

  private:
    void report(const char* what, double share) const {
        if (options_.progress) options_.progress(what, share);
    }

    const Options& options_;
    MotionView view_;
    Study study_;
    Search search_;
};

/// Half of an experiment, corrected by what the other half told, as an experiment of its own.
Asked asked(const Experiment& half, const Options& options, MotionView view) {
    Options quiet = options;
    quiet.progress = nullptr;
    Analysis other(half, quiet, view);
    (void)other.first();
    const Judged judged = other.decided(false);
    const auto& steps = (judged.refused ? *judged.refused : judged.chosen).selection.steps;
    Asked result;
    result.nothing = judged.decision == Decision::NoEffect;
    result.found = judged.found;
    result.what =
        steps.empty() ? "structure" : fmt::format("\"{}\"", other.effect(steps.front().effect).title);
    return result;
}

/// What half of an experiment selects by itself.
std::vector<std::size_t> chosen_on(const Experiment& half, const Options& options, MotionView view) {
    Options quiet = options;
    quiet.progress = nullptr;
    Analysis own(half, quiet, view);
    (void)own.first();
    return own.chosen();
}

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
    const auto best = static_cast<std::size_t>(std::ranges::max_element(score) - score.begin());
    Verdict verdict = views[best]->verdict();
    if (views.size() == 1) return verdict;
    if (verdict.decision == Decision::NoEffect) {
        Verdict other = views[1 - best]->verdict();
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

}  // namespace puckloop::gap
