// Each cause is held against what is left where it acts.

#include "gap/decide/left_beside.h"
#include "gap/pipeline/analyse.h"
#include "tests/gap/candidate.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// One board heard from one place; `received` of each message.
Experiment messages(double received) {
    constexpr int kRuns = 6, kMessages = 100;
    Experiment experiment;
    experiment.kind = Kind::Rab;
    experiment.title = "messages";
    for (int r = 0; r < kRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = kMessages;
        for (int k = 0; k < kMessages; ++k) {
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["distance_m"].push_back(0.1 + 0.01 * (k % 7));
            run.columns["true_bearing_rad"].push_back(0.1 * (k % 5));
            run.columns["received"].push_back(received);
            run.columns["strength"].push_back(1000 + 10 * ((k * 7) % 11));
            run.columns["bearing_rad"].push_back(0.1 * (k % 5) + 0.01 * ((k * 5) % 9));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

}  // namespace

TEST_CASE("a strong cause of one observable does not carry a weak one of another") {
    const Experiment experiment = messages(1);
    const Study study(experiment, 1);
    const std::size_t strong = candidate(study, "rab_strength_scale"),
                      weak = candidate(study, "bearing_offset");
    Selection selection;
    selection.chosen.effects = {strong, weak};
    selection.chosen.fitted.state = neutral_state(study.model());
    for (const std::size_t effect : selection.chosen.effects) {
        selection.chosen.fitted.state.values[study.candidates()[effect].freed.front().index] = 0.1;
        Trial step;
        step.effect = effect;
        step.held.sum = effect == strong ? 400 : 12;
        selection.steps.push_back(step);
    }
    FreeForm form;
    form.observable = "bearing";
    form.gain = 76;
    form.clear = true;
    CHECK(outweighed(study, selection, {form}, {}, 0.5) == std::vector{weak});
    form.observable = "strength";
    CHECK(outweighed(study, selection, {form}, {}, 0.2).empty());
    form.gain = 101;
    CHECK(outweighed(study, selection, {form}, {}, 0.2) == std::vector{strong});
    CHECK(outweighed(study, selection, {form}, {}, 0.5) == std::vector{strong});  // strengths do not add up
    form.clear = false;
    CHECK(outweighed(study, selection, {form}, {}, 0.2).empty());
    // A structure of p 1e-9 may stand for 17 nats.
    CHECK(outweighed(study, selection, {}, {{"bearing", "time", 1e-9, ""}}, 0.5) == std::vector{weak});
    CHECK(outweighed(study, selection, {}, {{"strength", "time", 1e-9, ""}}, 0.5).empty());
}

TEST_CASE("where every message is lost the plainest loss is named") {
    Experiment experiment = messages(0);
    for (Run& run : experiment.runs) {
        run.columns.erase("strength");
        run.columns.erase("bearing_rad");
    }
    const Verdict verdict = analyse(experiment);
    CHECK(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.size() == 1);
    CHECK(verdict.causes.front().name == "random_loss");
    CHECK(verdict.causes.front().parameters.front().high == 1.0);
}

TEST_CASE("where events alone were recorded and none is lost there is no effect") {
    Experiment experiment = messages(1);
    for (Run& run : experiment.runs) {
        run.columns.erase("strength");
        run.columns.erase("bearing_rad");
    }
    CHECK(analyse(experiment).decision == Decision::NoEffect);
}
